// The program's threads, and their waits for each other: conditions, locks, joins.
#include <pthread.h>
#include <time.h>

#include <cerrno>
#include <memory>

#include "libc/glibc_fields.h"
#include "roscpp_shim/clocks.h"
#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/node.h"
#include "roscpp_shim/recorder.h"
#include "roscpp_shim/turn.h"
#include "roscpp_shim/waits.h"

namespace move_base_abstract::shim {
namespace {

constexpr unsigned kVainWaits = 1000;

/**
 * @brief Take a lock. If a waiting thread of the program has it, wait by giving the turn away.
 * @param lasts longest wait, simulated ns. @return the function's result; EBUSY: it is taken.
 */
int takeByTurns(pthread_mutex_t* mutex, Nanoseconds lasts) {
  const Nanoseconds until = lasts == kNever ? kNever : node().now() + lasts;
  while (turn().holds()) {
    const int result = pthread_mutex_trylock(mutex);
    if (result != EBUSY) {
      return result;
    }
    if (!turn().isParked(ownerOf(*mutex))) {
      break;  // a thread of roscpp's own has it, and will release it soon
    }
    const auto is_free = [mutex] { return ownerOf(*mutex) == 0; };
    const Nanoseconds left = until == kNever ? kNever : until - node().now();
    if (awaitCondition(nullptr, is_free, left, "a lock") == Woken::kTime) {
      return ETIMEDOUT;
    }
  }
  return EBUSY;
}

int lockReally(pthread_mutex_t* mutex) {
  static auto* const function = real(&::pthread_mutex_lock, "pthread_mutex_lock");
  return function(mutex);
}

int lockMutex(pthread_mutex_t* mutex) {
  const int result = takeByTurns(mutex, kNever);
  return result == EBUSY ? lockReally(mutex) : result;
}

/** @return 0 or ETIMEDOUT. @param lasts simulated. */
int waitOn(pthread_cond_t* condition, pthread_mutex_t* mutex, Nanoseconds lasts) {
  Task& me = *Turn::self();
  if (lasts <= 0 && ++me.empty_polls >= kVainWaits) {  // not a wait, but a look, as many before
    tellPassage("a wait for a condition");
    lasts = kPassage;
  }
  Wait wait;
  wait.object = condition;
  wait.until = lasts == kNever ? kNever : node().now() + lasts;
  wait.for_thread = lasts == kNever;
  wait.what = "a condition";
  wait.unlock = [mutex] { pthread_mutex_unlock(mutex); };
  const Woken woken = turn().wait(std::move(wait));
  me.empty_polls = lasts > 0 ? 0 : me.empty_polls;
  lockMutex(mutex);
  return woken == Woken::kTime ? ETIMEDOUT : 0;
}

int waitOnUntil(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                const timespec& deadline) {
  return waitOn(condition, mutex, remaining(clock, deadline));
}

/** @brief The function of a thread that takes no turns. */
struct OtherMain {
  void* (*main)(void*);
  void* argument;
  void (*become)();                      // called first
  std::unique_ptr<WithoutTurns> counts;  // null for roscpp's own threads
};

void* runOther(void* argument) {
  const std::unique_ptr<OtherMain> what(static_cast<OtherMain*>(argument));
  what->become();
  return what->main(what->argument);
}

/** @return the function of a new thread; null: it takes turns, or the program is not in lockstep.
 */
std::unique_ptr<OtherMain> otherMain(void* (*main)(void*), void* argument, const void* caller) {
  const auto make = [&](void (*become)(), bool counts) {
    return std::make_unique<OtherMain>(
        OtherMain{main, argument, become, counts ? std::make_unique<WithoutTurns>() : nullptr});
  };
  if (Turn::startsInternal()) {
    return make(&Turn::becomeInternal, false);
  }
  if (isWorkerPool(caller)) {
    if (sees() != Sees::kMachine && !isIn(caller, {"libOpenCL", "libcuda"})) {
      tell(
          "a library starts threads for its sums or loops (TBB, OpenMP, BLAS), which take no turns",
          nullptr);
    }
    return make(&becomeWorker, true);
  }
  if (ordered() || sees() == Sees::kMachine || isRoscpps(caller)) {
    return nullptr;
  }
  if (isProgramsOwn(caller)) {
    tell("a thread was started before ROS was", caller);
  }
  return make([] {}, true);
}

/** @return how long a wait until @p deadline lasts; any value without the turn. */
Nanoseconds lasting(clockid_t clock, const timespec* deadline) {
  return deadline == nullptr ? kNever : remaining(clock, *deadline);
}

/** @return false if a thread of the program still runs after @p lasts simulated ns. */
bool awaitEndOf(pthread_t thread, Nanoseconds lasts) {
  const auto task = turn().holds() ? turn().find(thread) : nullptr;
  const auto has_ended = [one = task.get()] { return one->is_done.load(); };
  return task == nullptr || has_ended() ||
         awaitCondition(nullptr, has_ended, lasts, "the end of a thread", task.get()) !=
             Woken::kTime;
}

void* runTask(void* task) { return turn().run(static_cast<Task*>(task)); }

}  // namespace
}  // namespace move_base_abstract::shim

#pragma GCC visibility push(default)
extern "C" {

// ---- threads ---------------------------------------------------------------------------------

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*main)(void*),
                   void* argument) {
  static auto* const function = shim::real(&::pthread_create, "pthread_create");
  if (auto other = shim::otherMain(main, argument, MOVE_BASE_ABSTRACT_CALLER)) {
    const int result = function(thread, attributes, &shim::runOther, other.get());
    if (result == 0) {
      other.release();  // the thread has it
    }
    return result;
  }
  if (!shim::ordered()) {
    return function(thread, attributes, main, argument);
  }
  shim::Turn::self()->has_acted = true;
  const auto task = shim::turn().create([main, argument] { return main(argument); });
  const shim::Beside beside;  // libc keeps the memory of threads for other threads
  const int result = function(thread, attributes, &shim::runTask, task.get());
  if (result == 0) {
    task->thread = *thread;
  } else {
    shim::turn().discard(task);
  }
  return result;
}

int pthread_join(pthread_t thread, void** result) {
  static auto* const function = shim::real(&::pthread_join, "pthread_join");
  shim::awaitEndOf(thread, move_base_abstract::kNever);
  return function(thread, result);
}

int pthread_timedjoin_np(pthread_t thread, void** result, const timespec* deadline) {
  static auto* const function = shim::real(&::pthread_timedjoin_np, "pthread_timedjoin_np");
  if (!shim::awaitEndOf(thread, shim::lasting(CLOCK_REALTIME, deadline))) {
    return ETIMEDOUT;
  }
  const shim::MachineWait wait(CLOCK_REALTIME, deadline);
  return function(thread, result, wait.deadline());
}

// ---- locks and conditions --------------------------------------------------------------------

int pthread_mutex_lock(pthread_mutex_t* mutex) {
  return shim::Turn::self() == nullptr || shim::Turn::isInside() ? shim::lockReally(mutex)
                                                                 : shim::lockMutex(mutex);
}

int pthread_mutex_trylock(pthread_mutex_t* mutex) {
  static auto* const function = shim::real(&::pthread_mutex_trylock, "pthread_mutex_trylock");
  const int result = function(mutex);
  return shim::tried(result, result == EBUSY);
}

int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* deadline) {
  static auto* const function = shim::real(&::pthread_mutex_timedlock, "pthread_mutex_timedlock");
  const int result = shim::takeByTurns(mutex, shim::lasting(CLOCK_REALTIME, deadline));
  const shim::MachineWait wait(CLOCK_REALTIME, deadline);
  return result == EBUSY ? function(mutex, wait.deadline()) : result;
}

int pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clock, const timespec* deadline) {
  static auto* const function = shim::real(&::pthread_mutex_clocklock, "pthread_mutex_clocklock");
  const int result = shim::takeByTurns(mutex, shim::lasting(clock, deadline));
  const shim::MachineWait wait(clock, deadline);
  return result == EBUSY ? function(mutex, clock, wait.deadline()) : result;
}

int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  static auto* const function = shim::real(&::pthread_cond_wait, "pthread_cond_wait");
  if (!shim::ordered()) {
    return function(condition, mutex);
  }
  return shim::waitOn(condition, mutex, move_base_abstract::kNever);
}

int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex,
                           const timespec* deadline) {
  static auto* const function = shim::real(&::pthread_cond_timedwait, "pthread_cond_timedwait");
  const clockid_t clock = shim::clockOf(*condition);
  if (shim::ordered()) {
    return shim::isRecordersLook(MOVE_BASE_ABSTRACT_CALLER)
               ? shim::waitOn(condition, mutex, move_base_abstract::kNever)
               : shim::waitOnUntil(condition, mutex, clock, *deadline);
  }
  const shim::MachineWait wait(clock, deadline);
  const int result = function(condition, mutex, wait.deadline());
  if (result == ETIMEDOUT) {
    wait.timedOut();
  }
  return result;
}

int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                           const timespec* deadline) {
  static auto* const function = shim::real(&::pthread_cond_clockwait, "pthread_cond_clockwait");
  if (shim::ordered()) {
    return shim::waitOnUntil(condition, mutex, clock, *deadline);
  }
  const shim::MachineWait wait(clock, deadline);
  const int result = function(condition, mutex, clock, wait.deadline());
  if (result == ETIMEDOUT) {
    wait.timedOut();
  }
  return result;
}

int pthread_cond_signal(pthread_cond_t* condition) {
  static auto* const function = shim::real(&::pthread_cond_signal, "pthread_cond_signal");
  shim::turn().signal(condition, false);
  return function(condition);
}

int pthread_cond_broadcast(pthread_cond_t* condition) {
  static auto* const function = shim::real(&::pthread_cond_broadcast, "pthread_cond_broadcast");
  shim::turn().signal(condition, true);
  return function(condition);
}

}  // extern "C"
#pragma GCC visibility pop
