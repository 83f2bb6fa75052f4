#include "thread_stack.h"

#include <cxxabi.h>
#include <dlfcn.h>
#include <elf.h>
#include <execinfo.h>
#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <mutex>
#include <sstream>
#include <vector>

#include "roscpp_shim/machine/kernel.h"

namespace move_base_abstract::lockstep::internal {
namespace {

using shim::lineOf;
using shim::stateOf;
using shim::targetOf;

constexpr std::size_t kMostFrames = 64;
constexpr std::size_t kMostShown = 12;
constexpr int kAnswerLooks = 100;  // of 10 ms, wall

// The signal handler writes these. They belong to the thread that asks; one thread at a time.
std::array<void*, kMostFrames> frames;
std::atomic<int> asked{0};  // id of the thread that is asked
std::atomic<int> count{0};

void onAsked(int /*number*/) {
  const int error = errno;
  if (asked == static_cast<int>(::syscall(SYS_gettid))) {
    count = ::backtrace(frames.data(), static_cast<int>(kMostFrames));
    asked = 0;
  }
  errno = error;
}

struct Call {
  long number;
  const char* name;
  bool has_file;  // its first argument is a descriptor
  bool resumes;   // a signal does not end it
};

constexpr Call kCalls[] = {
    {SYS_read, "read", true, true},
    {SYS_write, "write", true, true},
    {SYS_readv, "readv", true, true},
    {SYS_writev, "writev", true, true},
    {SYS_wait4, "wait4", false, true},
    {SYS_waitid, "waitid", false, true},
    {SYS_flock, "flock", true, true},
    {SYS_futex, "futex (a lock or a condition)", false, false},
    {SYS_connect, "connect", true, false},
    {SYS_accept4, "accept", true, false},
    {SYS_recvfrom, "recv", true, false},
    {SYS_recvmsg, "recvmsg", true, false},
    {SYS_sendto, "send", true, false},
    {SYS_ppoll, "poll", false, false},
    {SYS_pselect6, "select", false, false},
    {SYS_epoll_pwait, "epoll_wait", false, false},
    {SYS_clock_nanosleep, "nanosleep", false, false},
#ifdef SYS_accept
    {SYS_accept, "accept", true, false},
#endif
#ifdef SYS_poll
    {SYS_poll, "poll", false, false},
    {SYS_select, "select", false, false},
    {SYS_epoll_wait, "epoll_wait", false, false},
#endif
};

/** @brief The system call that a thread is in, and whether a signal may be sent to it. */
struct Doing {
  std::string words;
  bool may_be_asked;
};

Doing doingOf(const std::string& id) {
  const char state = stateOf(id);
  if (state == '\0') {
    return {"has gone", false};
  }
  if (state == 'R') {
    return {"computes", true};
  }
  std::istringstream call(lineOf(id, "syscall"));
  long number = -1;
  std::string first;
  if (!(call >> number >> first)) {
    return {"waits in the system", false};
  }
  const auto known = std::find_if(std::begin(kCalls), std::end(kCalls),
                                  [number](const Call& one) { return one.number == number; });
  if (known == std::end(kCalls)) {
    return {"waits in call " + std::to_string(number) + " of the system", false};
  }
  std::string words = std::string("waits in ") + known->name;
  if (known->has_file) {
    const auto descriptor = static_cast<int>(std::strtol(first.c_str(), nullptr, 16));
    const std::string target = targetOf(descriptor);
    words += " of " + (target.empty() ? "descriptor " + std::to_string(descriptor) : target);
  }
  return {words, known->resumes};
}

std::string functionName(const char* symbol) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> demangled(
      abi::__cxa_demangle(symbol, nullptr, nullptr, &status), &std::free);
  return status == 0 ? demangled.get() : symbol;
}

/**
 * @return a frame as "function in file+0x12ab", for which addr2line finds the line; '': not known.
 */
std::string place(void* address) {
  const auto* const at = static_cast<const char*>(address) - 1;  // in the call, not after it
  Dl_info info;
  if (::dladdr(at, &info) == 0 || info.dli_fname == nullptr) {
    return "";
  }
  const auto* const head = static_cast<const Elf64_Ehdr*>(info.dli_fbase);
  const auto base = head->e_type == ET_DYN ? reinterpret_cast<std::uintptr_t>(info.dli_fbase) : 0;
  std::ostringstream text;
  if (info.dli_sname != nullptr) {
    text << functionName(info.dli_sname) << " in ";
  }
  text << info.dli_fname << "+0x" << std::hex << reinterpret_cast<std::uintptr_t>(at) - base;
  return text.str();
}

bool isOurs(const std::string& text) {
  return text.find("libmove_base_abstract_") != std::string::npos;
}

/** @return the places in the thread's functions, the innermost first. */
std::vector<std::string> stackOf(std::size_t depth) {
  std::vector<std::string> places;
  for (std::size_t k = 2; k < depth; ++k) {  // without the handler and its caller
    const std::string text = place(frames[k]);
    if (!text.empty() && !isOurs(text)) {
      places.push_back(text);
    }
  }
  return places;
}

std::string stackText(std::vector<std::string> places) {
  places.resize(std::min(places.size(), kMostShown));
  std::string text;
  for (auto one = places.rbegin(); one != places.rend(); ++one) {
    text += (text.empty() ? "" : " > ") + *one;
  }
  return text;
}

/** @return the places in the thread's functions; none if it does not answer. */
std::vector<std::string> askForStack(int id) {
  static std::mutex one_at_a_time;
  const std::lock_guard<std::mutex> lock(one_at_a_time);
  // The first call of backtrace() loads a library, which a signal handler must not do.
  ::backtrace(frames.data(), 1);
  struct sigaction own {};
  own.sa_handler = onAsked;
  own.sa_flags = SA_RESTART;
  struct sigaction before {};
  const int number = SIGRTMAX - 3;
  ::sigaction(number, nullptr, &before);
  const bool is_free = (before.sa_flags & SA_SIGINFO) == 0 &&
                       (before.sa_handler == SIG_DFL || before.sa_handler == onAsked);
  if (!is_free) {
    return {};
  }
  ::sigaction(number, &own, nullptr);
  asked = id;
  if (::syscall(SYS_tgkill, ::getpid(), id, number) != 0) {
    asked = 0;
    return {};
  }
  for (int look = 0; look < kAnswerLooks && asked != 0; ++look) {
    ::poll(nullptr, 0, 10);
  }
  int waiting = id;
  if (asked.compare_exchange_strong(waiting, 0)) {
    return {};  // the thread has blocked the signal
  }
  return stackOf(static_cast<std::size_t>(count));
}

}  // namespace

std::string describeThread(int id) {
  const Doing doing = doingOf(std::to_string(id));
  std::string text = "thread '" + lineOf(std::to_string(id), "comm") + "' " + doing.words;
  if (doing.may_be_asked) {
    const std::string stack = stackText(askForStack(id));
    text += stack.empty() ? "" : ": " + stack;
  }
  return text;
}

std::string describeBriefly(int id) {
  const Doing doing = doingOf(std::to_string(id));
  std::string text = doing.words.substr(0, doing.words.find(":["));  // a number of the kernel
  for (const std::string& one : doing.may_be_asked ? askForStack(id) : std::vector<std::string>()) {
    const std::string file = one.substr(one.find_last_of(' ') + 1);
    if (file.rfind("/usr/lib/", 0) != 0 && file.rfind("/lib/", 0) != 0 &&
        file.rfind("/opt/ros/", 0) != 0) {
      return text + ", in " + file;
    }
  }
  return text;
}

}  // namespace move_base_abstract::lockstep::internal
