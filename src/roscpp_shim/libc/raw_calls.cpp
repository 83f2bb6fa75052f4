// System calls that a program makes by their numbers, past the functions of libc.
#include <fcntl.h>
#include <linux/futex.h>
#include <sched.h>
#include <sys/random.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "libc/raw_call.h"
#include "roscpp_shim/clocks.h"
#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/node.h"
#include "roscpp_shim/turn.h"

namespace move_base_abstract::shim {
namespace {

/** Calls that ask for nothing, or whose answer is not the machine's. */
constexpr long kHarmless[] = {SYS_futex,         SYS_membarrier,         SYS_madvise,    SYS_mbind,
                              SYS_set_mempolicy, SYS_sched_setattr,      SYS_ioprio_set, SYS_prctl,
                              SYS_memfd_create,  SYS_sched_setscheduler, SYS_tgkill,     SYS_write,
                              SYS_close,         SYS_sched_setaffinity};

struct Named {
  long number;
  const char* name;
};
constexpr Named kNumbers[] = {{SYS_gettid, "gettid"},
                              {SYS_getpid, "getpid"},
                              {SYS_getppid, "getppid"},
                              {SYS_getcpu, "getcpu"}};

/** @brief Label the run if the program's own code makes a call that is not followed. */
void tellRaw(long number, const void* caller) {
  if (std::count(std::begin(kHarmless), std::end(kHarmless), number) > 0 ||
      !isProgramsOwn(caller)) {
    return;
  }
  for (const Named& one : kNumbers) {
    if (one.number == number) {
      tell("syscall(SYS_" + std::string(one.name) + ") is another number in another run", caller);
      return;
    }
  }
  tell("syscall(" + std::to_string(number) + ") is a system call past what is followed", caller);
}

/**
 * @brief Wait in turns for a word that another thread changes, as C++20's atomics, glib, Qt and
 * Rust do. @param deadline null: no end. @return 0; -1 with errno as the system call has it.
 */
long awaitFutex(int* word, int value, int operation, const timespec* deadline) {
  const auto is_over = [word, value] { return __atomic_load_n(word, __ATOMIC_SEQ_CST) != value; };
  if (is_over()) {
    errno = EAGAIN;
    return -1;
  }
  Nanoseconds lasts = kNever;
  if (deadline != nullptr) {
    const bool is_instant = (operation & FUTEX_CMD_MASK) == FUTEX_WAIT_BITSET;
    const bool is_date = (operation & FUTEX_CLOCK_REALTIME) != 0;
    lasts = is_instant ? remaining(is_date ? CLOCK_REALTIME : CLOCK_MONOTONIC, *deadline)
                       : toNs(*deadline);
  }
  Wait wait;
  wait.object = word;
  wait.is_over = is_over;
  wait.until = lasts == kNever ? kNever : node().now() + std::max<Nanoseconds>(lasts, 0);
  wait.for_thread = lasts == kNever;
  wait.what = "a futex";
  if (turn().wait(std::move(wait)) == Woken::kTime) {
    errno = ETIMEDOUT;
    return -1;
  }
  return 0;
}

bool isOneOf(int operation, std::initializer_list<int> kinds) {
  return std::count(kinds.begin(), kinds.end(), operation & FUTEX_CMD_MASK) > 0;
}

/** @return the result of the call of libc that does the same; nothing: there is none. */
std::optional<long> followedCall(long number, const long* words) {
  const auto operation = static_cast<int>(words[1]);
  auto* const time = reinterpret_cast<timespec*>(words[1]);
  switch (number) {
    case SYS_futex:
      if (ordered() && isOneOf(operation, {FUTEX_WAIT, FUTEX_WAIT_BITSET})) {
        return awaitFutex(reinterpret_cast<int*>(words[0]), static_cast<int>(words[2]), operation,
                          reinterpret_cast<const timespec*>(words[3]));
      }
      break;
    case SYS_getrandom:
      return ::getrandom(reinterpret_cast<void*>(words[0]), static_cast<std::size_t>(words[1]),
                         static_cast<unsigned>(words[2]));
    case SYS_clock_gettime:
      return ::clock_gettime(static_cast<clockid_t>(words[0]), time);
    case SYS_gettimeofday:
      return ::gettimeofday(reinterpret_cast<timeval*>(words[0]), nullptr);
    case SYS_nanosleep:
      return ::nanosleep(reinterpret_cast<const timespec*>(words[0]), time);
    case SYS_clock_nanosleep:
      errno = ::clock_nanosleep(static_cast<clockid_t>(words[0]), operation,
                                reinterpret_cast<const timespec*>(words[2]),
                                reinterpret_cast<timespec*>(words[3]));
      return errno == 0 ? 0 : -1;
    case SYS_openat:
      return ::openat(static_cast<int>(words[0]), reinterpret_cast<const char*>(words[1]),
                      static_cast<int>(words[2]), static_cast<mode_t>(words[3]));
    case SYS_sched_yield:
      return ::sched_yield();
    default:
      break;
  }
  return std::nullopt;
}

}  // namespace
}  // namespace move_base_abstract::shim

#pragma GCC visibility push(default)
extern "C" {

long rawCall(long number, long a, long b, long c, long d, long e, long f) noexcept {
  static auto* const function = shim::real<long(long, ...)>("syscall");
  const auto operation = static_cast<int>(b);
  if (number == SYS_futex && shim::isOneOf(operation, {FUTEX_WAKE, FUTEX_WAKE_BITSET})) {
    shim::turn().signal(reinterpret_cast<void*>(a), c != 1);
  }
  const void* const caller = MOVE_BASE_ABSTRACT_CALLER;
  if (shim::sees() != shim::Sees::kMachine && !shim::isIn(caller, {"roscpp_shim"})) {
    const long words[] = {a, b, c, d};
    if (const auto result = shim::followedCall(number, words)) {
      return *result;
    }
    shim::tellRaw(number, caller);
  }
  return function(number, a, b, c, d, e, f);
}

}  // extern "C"
#pragma GCC visibility pop
