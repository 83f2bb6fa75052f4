// Other ways in which threads wait for each other: semaphores, reader-writer locks, spin locks,
// futures.
#include <pthread.h>
#include <semaphore.h>

#include <cerrno>
#include <chrono>
#include <cstdarg>
#include <functional>
#include <future>
#include <map>
#include <mutex>
#include <set>

#include "roscpp_shim/clocks.h"
#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/node.h"
#include "roscpp_shim/turn.h"
#include "roscpp_shim/waits.h"

namespace move_base_abstract::shim {
namespace {

/** @brief The locks that the program's threads took in their turns. Other threads may release them.
 */
struct Holds {
  PlainMutex mutex;
  std::map<const void*, int> counts;
  std::set<const void*> shared;  // semaphores that other processes share
  std::uint64_t releases = 0;
};

Holds& holds() {
  static Holds* const instance = new Holds;
  return *instance;
}

/** @brief The lock of Holds, for looking at it or changing it. */
class Guard {
 public:
  explicit Guard(PlainMutex& mutex) : lock_(mutex) {}

 private:
  Beside beside_;
  std::lock_guard<PlainMutex> lock_;
};

bool isShared(const void* semaphore) {
  const Guard guard(holds().mutex);
  return holds().shared.count(semaphore) > 0;
}

void addShared(const void* semaphore, const void* caller) {
  const Guard guard(holds().mutex);
  if (holds().shared.insert(semaphore).second && sees() != Sees::kMachine) {
    tell("a semaphore is shared with other processes", caller);
  }
}

bool isHeld(const void* lock) {
  const Guard guard(holds().mutex);
  return holds().counts.count(lock) > 0;
}

int taken(const void* lock, int result) {
  if (result == 0 && ordered()) {
    const Guard guard(holds().mutex);
    ++holds().counts[lock];
  }
  return result;
}

int released(const void* lock, int result) {
  if (result == 0 && takesPart()) {
    const Guard guard(holds().mutex);
    const auto found = holds().counts.find(lock);
    ++holds().releases;
    if (found != holds().counts.end() && --found->second <= 0) {
      holds().counts.erase(found);
    }
  }
  return result;
}

std::uint64_t releases() {
  const Guard guard(holds().mutex);
  return holds().releases;
}

/**
 * @brief Take a lock. If one of the program's threads has it, wait by giving the turn away.
 * @return the result of @p attempt; EBUSY: another thread has it; ETIMEDOUT after @p lasts
 * simulated ns.
 */
int takeByTurns(const void* lock, const std::function<int()>& attempt, Nanoseconds lasts) {
  const Nanoseconds until = lasts == kNever ? kNever : node().now() + lasts;
  while (ordered()) {
    const int result = attempt();
    if (result != EBUSY || !isHeld(lock)) {
      return result;
    }
    const auto is_over = [before = releases()] { return releases() != before; };
    const Nanoseconds left = until == kNever ? kNever : until - node().now();
    if (awaitCondition(nullptr, is_over, left, "a lock") == Woken::kTime) {
      return ETIMEDOUT;
    }
  }
  return EBUSY;
}

/** @brief Take a lock until a deadline. If a thread that takes no turns has it, @p take waits by
 * the machine's clock. */
int takeUntil(const void* lock, const std::function<int()>& attempt, clockid_t clock,
              const timespec* deadline, const std::function<int(const timespec*)>& take) {
  const Nanoseconds lasts =
      deadline == nullptr || !ordered() ? kNever : remaining(clock, *deadline);
  const int result = takeByTurns(lock, attempt, lasts);
  const MachineWait wait(clock, deadline);
  return taken(lock, result == EBUSY ? take(wait.deadline()) : result);
}

/** @return the result of sem_wait(); @p take waits by the machine's clock. */
int takeSemaphore(sem_t* semaphore, clockid_t clock, const timespec* deadline,
                  const std::function<int(const timespec*)>& take) {
  if (ordered() && !isShared(semaphore)) {
    const Nanoseconds lasts = deadline == nullptr ? kNever : remaining(clock, *deadline);
    const Nanoseconds until = lasts == kNever ? kNever : node().now() + lasts;
    while (ordered()) {
      if (sem_trywait(semaphore) == 0) {
        return 0;
      }
      if (errno != EAGAIN) {
        return -1;
      }
      const auto is_over = [semaphore] {
        int value = 0;
        return sem_getvalue(semaphore, &value) == 0 && value > 0;
      };
      const Nanoseconds left = until == kNever ? kNever : until - node().now();
      if (awaitCondition(semaphore, is_over, left, "a semaphore") == Woken::kTime) {
        errno = ETIMEDOUT;
        return -1;
      }
    }
  }
  const MachineWait wait(clock, deadline);
  const int result = take(wait.deadline());
  if (result != 0 && errno == ETIMEDOUT) {
    wait.timedOut();
    errno = ETIMEDOUT;
  }
  return result;
}

}  // namespace
}  // namespace move_base_abstract::shim

#pragma GCC visibility push(default)
extern "C" {

// ---- semaphores ------------------------------------------------------------------------------

int sem_init(sem_t* semaphore, int shared, unsigned value) {
  static auto* const function = shim::real(&::sem_init, "sem_init");
  if (shared != 0) {
    shim::addShared(semaphore, MOVE_BASE_ABSTRACT_CALLER);
  }
  return function(semaphore, shared, value);
}

sem_t* sem_open(const char* name, int flags, ...) {
  static auto* const function = shim::real(&::sem_open, "sem_open");
  va_list rest;
  va_start(rest, flags);
  const auto mode = va_arg(rest, unsigned);  // the function reads it if flags say so
  const auto value = va_arg(rest, unsigned);
  va_end(rest);
  sem_t* const semaphore = function(name, flags, mode, value);
  shim::addShared(semaphore, MOVE_BASE_ABSTRACT_CALLER);
  return semaphore;
}

int sem_wait(sem_t* semaphore) {
  static auto* const function = shim::real(&::sem_wait, "sem_wait");
  return shim::takeSemaphore(semaphore, CLOCK_REALTIME, nullptr,
                             [semaphore](const timespec*) { return function(semaphore); });
}

int sem_trywait(sem_t* semaphore) {
  static auto* const function = shim::real(&::sem_trywait, "sem_trywait");
  const int result = function(semaphore);
  return shim::tried(result, result != 0 && errno == EAGAIN);
}

int sem_timedwait(sem_t* semaphore, const timespec* deadline) {
  static auto* const function = shim::real(&::sem_timedwait, "sem_timedwait");
  return shim::takeSemaphore(semaphore, CLOCK_REALTIME, deadline,
                             [semaphore](const timespec* by) { return function(semaphore, by); });
}

int sem_clockwait(sem_t* semaphore, clockid_t clock, const timespec* deadline) {
  static auto* const function = shim::real(&::sem_clockwait, "sem_clockwait");
  return shim::takeSemaphore(semaphore, clock, deadline, [semaphore, clock](const timespec* by) {
    return function(semaphore, clock, by);
  });
}

int sem_post(sem_t* semaphore) {
  static auto* const function = shim::real(&::sem_post, "sem_post");
  const int result = function(semaphore);
  if (shim::Turn::self() == nullptr) {  // the program's own threads look at the value
    shim::turn().signal(semaphore, false);
  }
  return result;
}

// ---- locks of readers and writers, and spin locks --------------------------------------------

int pthread_rwlock_rdlock(pthread_rwlock_t* lock) {
  static auto* const function = shim::real(&::pthread_rwlock_rdlock, "pthread_rwlock_rdlock");
  return shim::takeUntil(
      lock, [lock] { return pthread_rwlock_tryrdlock(lock); }, CLOCK_REALTIME, nullptr,
      [lock](const timespec*) { return function(lock); });
}

int pthread_rwlock_wrlock(pthread_rwlock_t* lock) {
  static auto* const function = shim::real(&::pthread_rwlock_wrlock, "pthread_rwlock_wrlock");
  return shim::takeUntil(
      lock, [lock] { return pthread_rwlock_trywrlock(lock); }, CLOCK_REALTIME, nullptr,
      [lock](const timespec*) { return function(lock); });
}

int pthread_rwlock_tryrdlock(pthread_rwlock_t* lock) {
  static auto* const function = shim::real(&::pthread_rwlock_tryrdlock, "pthread_rwlock_tryrdlock");
  const int result = function(lock);
  return shim::tried(result, result == EBUSY);
}

int pthread_rwlock_trywrlock(pthread_rwlock_t* lock) {
  static auto* const function = shim::real(&::pthread_rwlock_trywrlock, "pthread_rwlock_trywrlock");
  const int result = function(lock);
  return shim::tried(result, result == EBUSY);
}

int pthread_rwlock_timedrdlock(pthread_rwlock_t* lock, const timespec* deadline) {
  static auto* const function =
      shim::real(&::pthread_rwlock_timedrdlock, "pthread_rwlock_timedrdlock");
  return shim::takeUntil(
      lock, [lock] { return pthread_rwlock_tryrdlock(lock); }, CLOCK_REALTIME, deadline,
      [lock](const timespec* by) { return function(lock, by); });
}

int pthread_rwlock_timedwrlock(pthread_rwlock_t* lock, const timespec* deadline) {
  static auto* const function =
      shim::real(&::pthread_rwlock_timedwrlock, "pthread_rwlock_timedwrlock");
  return shim::takeUntil(
      lock, [lock] { return pthread_rwlock_trywrlock(lock); }, CLOCK_REALTIME, deadline,
      [lock](const timespec* by) { return function(lock, by); });
}

int pthread_rwlock_clockrdlock(pthread_rwlock_t* lock, clockid_t clock, const timespec* deadline) {
  static auto* const function =
      shim::real(&::pthread_rwlock_clockrdlock, "pthread_rwlock_clockrdlock");
  return shim::takeUntil(
      lock, [lock] { return pthread_rwlock_tryrdlock(lock); }, clock, deadline,
      [lock, clock](const timespec* by) { return function(lock, clock, by); });
}

int pthread_rwlock_clockwrlock(pthread_rwlock_t* lock, clockid_t clock, const timespec* deadline) {
  static auto* const function =
      shim::real(&::pthread_rwlock_clockwrlock, "pthread_rwlock_clockwrlock");
  return shim::takeUntil(
      lock, [lock] { return pthread_rwlock_trywrlock(lock); }, clock, deadline,
      [lock, clock](const timespec* by) { return function(lock, clock, by); });
}

int pthread_rwlock_unlock(pthread_rwlock_t* lock) {
  static auto* const function = shim::real(&::pthread_rwlock_unlock, "pthread_rwlock_unlock");
  return shim::released(lock, function(lock));
}

int pthread_spin_lock(pthread_spinlock_t* lock) {
  static auto* const function = shim::real(&::pthread_spin_lock, "pthread_spin_lock");
  return shim::takeUntil(
      const_cast<int*>(lock), [lock] { return pthread_spin_trylock(lock); }, CLOCK_REALTIME,
      nullptr, [lock](const timespec*) { return function(lock); });
}

int pthread_spin_trylock(pthread_spinlock_t* lock) {
  static auto* const function = shim::real(&::pthread_spin_trylock, "pthread_spin_trylock");
  const int result = function(lock);
  return shim::tried(result, result == EBUSY);
}

int pthread_spin_unlock(pthread_spinlock_t* lock) {
  static auto* const function = shim::real(&::pthread_spin_unlock, "pthread_spin_unlock");
  return shim::released(const_cast<int*>(lock), function(lock));
}

}  // extern "C"

// ---- std::future -----------------------------------------------------------------------------

namespace std {

namespace {

using FutexWait = bool(__atomic_futex_unsigned_base*, unsigned*, unsigned, bool, chrono::seconds,
                       chrono::nanoseconds);

/** @return false if the time is over. */
bool awaitFutex(__atomic_futex_unsigned_base* self, unsigned* word, unsigned value, bool has_end,
                clockid_t clock, chrono::seconds seconds, chrono::nanoseconds rest,
                FutexWait* function) {
  const timespec end{seconds.count(), rest.count()};
  const timespec* const deadline = has_end ? &end : nullptr;
  if (shim::ordered()) {
    const auto is_over = [word, value] { return __atomic_load_n(word, __ATOMIC_SEQ_CST) != value; };
    const auto lasts = has_end ? shim::remaining(clock, end) : move_base_abstract::kNever;
    const shim::Woken woken = shim::awaitCondition(word, is_over, lasts, "a future");
    if (woken != shim::Woken::kEnd) {
      return woken == shim::Woken::kReady;
    }
  }
  const shim::MachineWait wait(clock, deadline);
  const timespec by = has_end ? *wait.deadline() : end;
  const bool is_over = function(self, word, value, has_end, chrono::seconds(by.tv_sec),
                                chrono::nanoseconds(by.tv_nsec));
  if (!is_over) {
    wait.timedOut();
  }
  return is_over;
}

}  // namespace

bool __atomic_futex_unsigned_base::_M_futex_wait_until(unsigned* word, unsigned value, bool has_end,
                                                       chrono::seconds seconds,
                                                       chrono::nanoseconds rest) {
  static auto* const function =
      shim::real(&__atomic_futex_unsigned_base::_M_futex_wait_until, "std::future::get");
  return awaitFutex(this, word, value, has_end, CLOCK_REALTIME, seconds, rest, function);
}

#if __GNUC__ >= 11
bool __atomic_futex_unsigned_base::_M_futex_wait_until_steady(unsigned* word, unsigned value,
                                                              bool has_end, chrono::seconds seconds,
                                                              chrono::nanoseconds rest) {
  static auto* const function = shim::real(
      &__atomic_futex_unsigned_base::_M_futex_wait_until_steady, "std::future::wait_for");
  return awaitFutex(this, word, value, has_end, CLOCK_MONOTONIC, seconds, rest, function);
}
#endif

void __atomic_futex_unsigned_base::_M_futex_notify_all(unsigned* word) {
  static auto* const function =
      shim::real(&__atomic_futex_unsigned_base::_M_futex_notify_all, "std::promise::set_value");
  shim::turn().signal(word, true);
  function(word);
}

}  // namespace std
#pragma GCC visibility pop
