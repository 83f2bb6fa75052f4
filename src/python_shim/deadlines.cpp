// Waits until an instant of a clock that a library has read, which is not the machine's. No ROS.
#include <linux/futex.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>

#include "clocks.h"
#include "libc/glibc_fields.h"
#include "libc/raw_call.h"
#include "real.h"

namespace move_base_abstract::native {
namespace {

/** @brief A deadline by a clock that the library sees, translated into the machine's clock. */
class Deadline {
 public:
  Deadline(clockid_t clock, const timespec* deadline, const void* caller)
      : whose_(deadline == nullptr ? Sees::kMachine : sees(caller)), deadline_(deadline) {
    constexpr Nanoseconds kForEver = 100'000'000 * kSecond;  // three years
    if (whose_ == Sees::kMachine || deadline->tv_nsec < 0 || deadline->tv_nsec >= kSecond) {
      return;
    }
    const Nanoseconds seen = seenTime(clock, whose_);
    const bool is_far = deadline->tv_sec - seen / kSecond >= kForEver / kSecond;
    lasts_ = is_far ? kForEver : shim::toNs(*deadline) - seen;
    lasts_ = lasts_ < 0 ? 0 : lasts_;
    translated_ = shim::toTimespec(machineTime(clock) + lasts_);
    deadline_ = &translated_;
  }
  /** @return the deadline by the machine's clock; null if there is no deadline. */
  const timespec* operator*() const { return deadline_; }
  /** @brief Move the clocks that are seen on by the wait, if it timed out. @return @p result. */
  int over(int result, bool is_timed_out) const {
    if (is_timed_out && deadline_ == &translated_) {
      goOn(lasts_, whose_);
    }
    return result;
  }
  int over(int result) const { return over(result, result == ETIMEDOUT); }

 private:
  Sees whose_;
  Nanoseconds lasts_ = 0;
  timespec translated_{};
  const timespec* deadline_;
};

}  // namespace
}  // namespace move_base_abstract::native

#pragma GCC visibility push(default)
extern "C" {

int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex,
                           const timespec* until) {
  static native::Real<int(pthread_cond_t*, pthread_mutex_t*, const timespec*)> function(
      "pthread_cond_timedwait");
  const native::Deadline deadline(shim::clockOf(*condition), until, MOVE_BASE_ABSTRACT_CALLER);
  return deadline.over(function(condition, mutex, *deadline));
}

int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                           const timespec* until) {
  static native::Real<int(pthread_cond_t*, pthread_mutex_t*, clockid_t, const timespec*)> function(
      "pthread_cond_clockwait");
  const native::Deadline deadline(clock, until, MOVE_BASE_ABSTRACT_CALLER);
  return deadline.over(function(condition, mutex, clock, *deadline));
}

int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* until) {
  static native::Real<int(pthread_mutex_t*, const timespec*)> function("pthread_mutex_timedlock");
  const native::Deadline deadline(CLOCK_REALTIME, until, MOVE_BASE_ABSTRACT_CALLER);
  return deadline.over(function(mutex, *deadline));
}

int pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clock, const timespec* until) {
  static native::Real<int(pthread_mutex_t*, clockid_t, const timespec*)> function(
      "pthread_mutex_clocklock");
  const native::Deadline deadline(clock, until, MOVE_BASE_ABSTRACT_CALLER);
  return deadline.over(function(mutex, clock, *deadline));
}

int pthread_rwlock_timedrdlock(pthread_rwlock_t* lock, const timespec* until) {
  static native::Real<int(pthread_rwlock_t*, const timespec*)> function(
      "pthread_rwlock_timedrdlock");
  const native::Deadline deadline(CLOCK_REALTIME, until, MOVE_BASE_ABSTRACT_CALLER);
  return deadline.over(function(lock, *deadline));
}

int pthread_rwlock_timedwrlock(pthread_rwlock_t* lock, const timespec* until) {
  static native::Real<int(pthread_rwlock_t*, const timespec*)> function(
      "pthread_rwlock_timedwrlock");
  const native::Deadline deadline(CLOCK_REALTIME, until, MOVE_BASE_ABSTRACT_CALLER);
  return deadline.over(function(lock, *deadline));
}

int pthread_rwlock_clockrdlock(pthread_rwlock_t* lock, clockid_t clock, const timespec* until) {
  static native::Real<int(pthread_rwlock_t*, clockid_t, const timespec*)> function(
      "pthread_rwlock_clockrdlock");
  const native::Deadline deadline(clock, until, MOVE_BASE_ABSTRACT_CALLER);
  return deadline.over(function(lock, clock, *deadline));
}

int pthread_rwlock_clockwrlock(pthread_rwlock_t* lock, clockid_t clock, const timespec* until) {
  static native::Real<int(pthread_rwlock_t*, clockid_t, const timespec*)> function(
      "pthread_rwlock_clockwrlock");
  const native::Deadline deadline(clock, until, MOVE_BASE_ABSTRACT_CALLER);
  return deadline.over(function(lock, clock, *deadline));
}

int pthread_timedjoin_np(pthread_t thread, void** result, const timespec* until) {
  static native::Real<int(pthread_t, void**, const timespec*)> function("pthread_timedjoin_np");
  const native::Deadline deadline(CLOCK_REALTIME, until, MOVE_BASE_ABSTRACT_CALLER);
  return deadline.over(function(thread, result, *deadline));
}

int sem_timedwait(sem_t* semaphore, const timespec* until) {
  static native::Real<int(sem_t*, const timespec*)> function("sem_timedwait");
  const native::Deadline deadline(CLOCK_REALTIME, until, MOVE_BASE_ABSTRACT_CALLER);
  const int result = function(semaphore, *deadline);
  return deadline.over(result, result != 0 && errno == ETIMEDOUT);
}

int sem_clockwait(sem_t* semaphore, clockid_t clock, const timespec* until) {
  static native::Real<int(sem_t*, clockid_t, const timespec*)> function("sem_clockwait");
  const native::Deadline deadline(clock, until, MOVE_BASE_ABSTRACT_CALLER);
  const int result = function(semaphore, clock, *deadline);
  return deadline.over(result, result != 0 && errno == ETIMEDOUT);
}

/** By this function the C++ library (std::future), Abseil and Rust wait for a futex until an
 * instant. */
long rawCall(long number, long a, long b, long c, long d, long e, long f) noexcept {
  static native::Real<long(long, ...)> function("syscall");
  if (number != SYS_futex || (b & FUTEX_CMD_MASK) != FUTEX_WAIT_BITSET) {
    return function.get()(number, a, b, c, d, e, f);
  }
  const clockid_t clock = (b & FUTEX_CLOCK_REALTIME) != 0 ? CLOCK_REALTIME : CLOCK_MONOTONIC;
  const native::Deadline deadline(clock, reinterpret_cast<const timespec*>(d),
                                  MOVE_BASE_ABSTRACT_CALLER);
  const long result = function.get()(number, a, b, c, reinterpret_cast<long>(*deadline), e, f);
  deadline.over(0, result != 0 && errno == ETIMEDOUT);
  return result;
}

}  // extern "C"
#pragma GCC visibility pop
