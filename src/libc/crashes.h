// The last word of a process that crashes: by it, its time master knows that no other process has
// killed it. Whoever includes this has the CrashWord. No ROS.
#pragma once

#include <pthread.h>
#include <signal.h>
#include <stddef.h>
#include <sys/socket.h>
#include <sys/types.h>

#include <atomic>

namespace move_base_abstract::shim {

constexpr int kCrashes[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

/** What a signal handler sends, and where to. */
struct CrashWord {
  std::atomic<int> socket{-1};  // -1: nowhere
  const char* bytes = nullptr;
  size_t size = 0;
  pid_t process = 0;
};

template <CrashWord& word>
void onCrash(int number, siginfo_t* info, void* /*context*/) {
  const bool is_sent = info->si_code <= 0;  // by kill(), and not by the kernel for a fault
  if (const int socket = word.socket.exchange(-1);
      socket >= 0 && (!is_sent || info->si_pid == word.process)) {
    ::send(socket, word.bytes, word.size, MSG_NOSIGNAL | MSG_DONTWAIT);
  }
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  ::sigaction(number, &usual, nullptr);
  if (is_sent) {
    ::raise(number);  // when this handler has returned; a fault happens again by itself
  }
}

/**
 * @brief Send the word to its socket when the process crashes, unless the program handles that
 * itself. A fork of the process does not.
 */
template <CrashWord& word>
void tellOfCrashes() {
  static const int forks = ::pthread_atfork(nullptr, nullptr, [] { word.socket = -1; });
  for (const int number : kCrashes) {
    struct sigaction present {};
    ::sigaction(number, nullptr, &present);
    if (forks == 0 && (present.sa_flags & SA_SIGINFO) == 0 && present.sa_handler == SIG_DFL) {
      present.sa_sigaction = onCrash<word>;
      present.sa_flags = SA_SIGINFO | SA_ONSTACK;
      ::sigaction(number, &present, nullptr);
    }
  }
}

}  // namespace move_base_abstract::shim
