#include "stop_signals.h"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <string>

#include "libc/crashes.h"
#include "lockstep/wire/wire.h"

namespace move_base_abstract::lockstep::internal {
namespace {

constexpr std::array<int, 2> kSignals = {SIGINT, SIGTERM};

// A signal handler may use these: they do not allocate and have no lock.
std::atomic<int> connection{-1};
std::atomic<int> senders{0};
std::atomic<std::uint64_t> sent_bytes{0};
std::atomic<bool> came{false};
std::atomic<bool> due{false};
std::atomic<int> ending{0};  // the signal that ends the process once STOPPING is sent; 0: none
std::string* frame = nullptr;
shim::CrashWord crash_word;
std::array<struct sigaction, 2> replaced_actions;

void tell() {
  if (const int socket = connection.exchange(-1); socket >= 0) {
    const auto sent = ::send(socket, frame->data(), frame->size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    sent_bytes += sent > 0 ? static_cast<std::uint64_t>(sent) : 0;
  }
}

/** Go on as if the signal had no handler: it ends the process. */
void endBy(int number) {
  ending = number;
  // A thread that is sending now, perhaps this one, sends STOPPING next and ends the process.
  if (!due && ending.exchange(0) != 0) {
    ::raise(number);  // when this handler has returned
  }
}

void onSignal(int number, siginfo_t* info, void* context) {
  const int error = errno;
  came = true;
  if (senders == 0) {
    tell();
  } else {
    due = true;
    if (senders == 0 && due.exchange(false)) {
      tell();
    }
  }
  const struct sigaction& other = replaced_actions[number == SIGINT ? 0 : 1];
  if ((other.sa_flags & SA_SIGINFO) != 0) {
    other.sa_sigaction(number, info, context);
  } else if (other.sa_handler == SIG_DFL) {
    ::sigaction(number, &other, nullptr);
    endBy(number);
  } else {
    other.sa_handler(number);
  }
  errno = error;
}

}  // namespace

Sending::Sending() { ++senders; }

Sending::~Sending() {
  if (--senders == 0 && due.exchange(false)) {
    tell();
    if (const int number = ending.exchange(0); number != 0) {
      sigset_t only;
      ::sigemptyset(&only);
      ::sigaddset(&only, number);
      ::pthread_sigmask(SIG_UNBLOCK, &only, nullptr);  // this thread may have blocked it
      ::raise(number);
    }
  }
}

void announceStopSignals(int socket) {
  static std::string stopping =
      wire::encode(wire::ParticipantFrame(wire::Stopping{"a signal has told it to end"}));
  frame = &stopping;
  connection = socket;
  static const std::string crashing = wire::encode(wire::ParticipantFrame(wire::Crashing{}));
  crash_word.bytes = crashing.data();
  crash_word.size = crashing.size();
  crash_word.process = ::getpid();
  crash_word.socket = socket;
  shim::tellOfCrashes<crash_word>();
  static bool is_installed = false;
  if (is_installed) {
    return;
  }
  is_installed = true;
  for (std::size_t k = 0; k < kSignals.size(); ++k) {
    ::sigaction(kSignals[k], nullptr, &replaced_actions[k]);
    if ((replaced_actions[k].sa_flags & SA_SIGINFO) == 0 &&
        replaced_actions[k].sa_handler == SIG_IGN) {
      continue;
    }
    struct sigaction own {};
    own.sa_sigaction = onSignal;
    own.sa_mask = replaced_actions[k].sa_mask;
    own.sa_flags = (replaced_actions[k].sa_flags & SA_RESTART) | SA_SIGINFO;
    ::sigaction(kSignals[k], &own, nullptr);
  }
}

void forgetStopSignals(int socket) {
  int mine = socket;
  connection.compare_exchange_strong(mine, -1);
  mine = socket;
  crash_word.socket.compare_exchange_strong(mine, -1);
}

bool stopSignalCame() { return came; }

std::uint64_t stopSignalBytes() { return sent_bytes; }

}  // namespace move_base_abstract::lockstep::internal
