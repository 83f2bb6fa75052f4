// The program's threads, and where they wait by means of libc: conditions, locks, joins, sleeps.
#include <dlfcn.h>
#include <pthread.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "glibc_fields.h"
#include "node.h"
#include "real.h"
#include "turn.h"

namespace move_base_abstract::shim {
namespace {

constexpr Nanoseconds kSecond = 1'000'000'000;
constexpr unsigned kVainWaits = 1000;
constexpr Nanoseconds kPollPeriod = 1'000'000;
constexpr Nanoseconds kPatience = 5 * kSecond;  // wall

using GetTime = int(clockid_t, timespec*);
using Lock = int(pthread_mutex_t*);
using CondWait = int(pthread_cond_t*, pthread_mutex_t*);
using CondTimedWait = int(pthread_cond_t*, pthread_mutex_t*, const timespec*);
using CondClockWait = int(pthread_cond_t*, pthread_mutex_t*, clockid_t, const timespec*);
using CondSignal = int(pthread_cond_t*);
using Create = int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
using NanoSleep = int(const timespec*, timespec*);

constexpr Nanoseconds kPreparation = 1'000'000;  // of a thread's processor time

/** @brief What a thread has read from the clocks of the wall: what its next deadline starts from.
 */
struct Readings {
  Nanoseconds last[2] = {0, 0};
  std::uint64_t round = 0;  // in which it has read first, with these real clocks
  Nanoseconds processor = 0;
  Nanoseconds monotonic = 0;
};
thread_local Readings t_readings __attribute__((tls_model("initial-exec")));

Nanoseconds toNs(const timespec& time) { return time.tv_sec * kSecond + time.tv_nsec; }
timespec toTimespec(Nanoseconds time) { return {time / kSecond, time % kSecond}; }

GetTime* realGetTime() {
  static GetTime* const function = real<GetTime>("clock_gettime");
  return function;
}

/**
 * @brief The clocks of the wall as the program's threads see them: they go on with simulated time,
 * and stand while a thread only prepares a wait, so that its deadline is exact.
 *
 * What a thread computes for longer is seen, too; not so with --sleep simulated, where both clocks
 * are simulated time itself. ros::WallTime stays the wall's (without --sleep simulated).
 */
class SeenClock {
 public:
  Nanoseconds read(clockid_t clock) {
    const Nanoseconds simulated = node().now();
    if (node().sleepsSimulated()) {
      return simulated;
    }
    const Nanoseconds processor = read(CLOCK_THREAD_CPUTIME_ID, 0);
    const Nanoseconds monotonic = read(CLOCK_MONOTONIC, 0);
    if (begin_ == 0) {
      begin_ = simulated;
      walls_[0] = read(CLOCK_REALTIME, 0);
      walls_[1] = monotonic;
    }
    Readings& mine = t_readings;
    if (mine.round != node().round()) {
      mine = Readings();
      mine.round = node().round();
      mine.processor = processor;
      mine.monotonic = monotonic;
    } else if (processor - mine.processor > kPreparation) {
      computed_ += monotonic - mine.monotonic;
      mine.processor = processor;
      mine.monotonic = monotonic;
    }
    return walls_[clock == CLOCK_REALTIME ? 0 : 1] + simulated - begin_ + computed_;
  }

  void addSleep(Nanoseconds duration) { computed_ += duration; }

 private:
  static Nanoseconds read(clockid_t clock, int) {
    timespec now{};
    realGetTime()(clock, &now);
    return toNs(now);
  }

  Nanoseconds begin_ = 0;
  Nanoseconds walls_[2] = {0, 0};
  Nanoseconds computed_ = 0;  // only who has the turn reads or writes
};

SeenClock& seenClock() {
  static SeenClock* const instance = new SeenClock;
  return *instance;
}

/** @brief One of the program's threads reads a clock, of which it sees @p step [ns]. */
Nanoseconds readSeen(clockid_t clock, Nanoseconds step) {
  const Nanoseconds now = seenClock().read(clock);
  t_readings.last[clock == CLOCK_REALTIME ? 0 : 1] = now - now % step;
  return now - now % step;
}

/** @return how long a wait until @p deadline is meant to last. */
Nanoseconds remaining(clockid_t clock, const timespec& deadline) {
  const int index = clock == CLOCK_REALTIME ? 0 : 1;
  const bool is_fresh = t_readings.round == node().round() && t_readings.last[index] > 0;
  // The thread may have computed since it read the clock, or may have been held up.
  return toNs(deadline) - (is_fresh ? t_readings.last[index] : readSeen(clock, 1));
}

/** @brief Take a lock; where one of the program's waiting threads has it, let that one go on. */
int lockMutex(pthread_mutex_t* mutex, Lock* lock) {
  while (turn().holds()) {
    const int result = pthread_mutex_trylock(mutex);
    if (result != EBUSY) {
      return result;
    }
    if (!turn().isParked(ownerOf(*mutex))) {
      break;  // roscpp's own, which will be through soon
    }
    Wait wait;
    wait.is_over = [mutex] { return ownerOf(*mutex) == 0; };
    wait.for_thread = true;
    turn().wait(std::move(wait));
  }
  return lock(mutex);
}

Lock* realLock() {
  static Lock* const function = real<Lock>("pthread_mutex_lock");
  return function;
}

/** @return 0 or ETIMEDOUT. @param lasts simulated. */
int waitOn(pthread_cond_t* condition, pthread_mutex_t* mutex, Nanoseconds lasts) {
  Task& me = *Turn::self();
  if (lasts <= 0) {  // a look, no wait; but one that only looks lets time go on some day
    lasts = ++me.empty_polls >= kVainWaits ? kPollPeriod : 0;
  }
  Wait wait;
  wait.object = condition;
  wait.until = lasts == kNever ? kNever : node().now() + lasts;
  wait.for_thread = lasts == kNever;
  wait.unlock = [mutex] { pthread_mutex_unlock(mutex); };
  const Woken woken = turn().wait(std::move(wait));
  me.empty_polls = lasts > 0 ? 0 : me.empty_polls;
  lockMutex(mutex, realLock());
  return woken == Woken::kTime ? ETIMEDOUT : 0;
}

int waitOnUntil(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                const timespec& deadline) {
  return waitOn(condition, mutex, remaining(clock, deadline));
}

/** @brief A sleep by the wall clock, of a thread that has the turn. */
void sleepWall(Nanoseconds duration, const timespec& request, NanoSleep* sleep) {
  Task& me = *Turn::self();
  me.has_acted = true;
  Wait wait;
  if (node().sleepsSimulated()) {
    wait.until = node().now() + duration;
    turn().wait(std::move(wait));
    return;
  }
  me.slept = me.slept_at == node().now() ? me.slept + duration : duration;
  me.slept_at = node().now();
  {
    const Blocking blocking;
    sleep(&request, nullptr);
  }
  if (me.slept < kPatience) {
    seenClock().addSleep(duration);
    wait.next_round = true;  // what has happened at this instant is seen after the sleep
  } else {
    node().label(
        "a thread sleeps by the wall clock until something happens (see --sleep simulated)");
    wait.until = node().now() + duration;
  }
  turn().wait(std::move(wait));
}

NanoSleep* realNanosleep() {
  static NanoSleep* const function = real<NanoSleep>("nanosleep");
  return function;
}

/** @return whether a library of worker threads calls: they wait for each other in ways of their
 * own. */
bool isWorkerPool(const void* caller) {
  Dl_info info{};
  if (dladdr(caller, &info) == 0 || info.dli_fname == nullptr) {
    return false;
  }
  for (const char* name : {"libgomp", "libtbb", "libomp", "blas", "libOpenCL", "libcuda"}) {
    if (std::strstr(info.dli_fname, name) != nullptr) {
      return true;
    }
  }
  return false;
}

struct InternalMain {
  void* (*main)(void*);
  void* argument;
};

void* runInternal(void* argument) {
  const InternalMain what = *static_cast<InternalMain*>(argument);
  delete static_cast<InternalMain*>(argument);
  Turn::becomeInternal();
  return what.main(what.argument);
}

void* runTask(void* task) { return turn().run(static_cast<Task*>(task)); }

}  // namespace
}  // namespace move_base_abstract::shim

namespace shim = move_base_abstract::shim;

#pragma GCC visibility push(default)
extern "C" {

// ---- threads ---------------------------------------------------------------------------------

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*main)(void*),
                   void* argument) {
  static shim::Create* const function = shim::real<shim::Create>("pthread_create");
  if (shim::Turn::isInternal() || shim::Turn::isInside()) {
    return function(thread, attributes, &shim::runInternal, new shim::InternalMain{main, argument});
  }
  if (!shim::turn().holds() || shim::isWorkerPool(__builtin_return_address(0))) {
    return function(thread, attributes, main, argument);
  }
  shim::Turn::self()->has_acted = true;
  shim::Task* const task = shim::turn().create([main, argument] { return main(argument); });
  const int result = function(thread, attributes, &shim::runTask, task);
  if (result == 0) {
    task->thread = *thread;
  }
  return result;
}

int pthread_join(pthread_t thread, void** result) {
  using Join = int(pthread_t, void**);
  static Join* const function = shim::real<Join>("pthread_join");
  if (shim::turn().holds()) {
    if (const shim::Task* const task = shim::turn().find(thread)) {
      shim::Wait wait;
      wait.is_over = [task] { return task->is_done.load(); };
      wait.for_thread = true;
      shim::turn().wait(std::move(wait));
    }
  }
  return function(thread, result);
}

// ---- locks and conditions --------------------------------------------------------------------

int pthread_mutex_lock(pthread_mutex_t* mutex) {
  static shim::Lock* const function = shim::realLock();
  if (shim::Turn::self() == nullptr || shim::Turn::isInside()) {
    return function(mutex);
  }
  return shim::lockMutex(mutex, function);
}

int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  static shim::CondWait* const function = shim::real<shim::CondWait>("pthread_cond_wait");
  if (!shim::turn().holds()) {
    return function(condition, mutex);
  }
  return shim::waitOn(condition, mutex, move_base_abstract::kNever);
}

int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex,
                           const timespec* deadline) {
  static shim::CondTimedWait* const function =
      shim::real<shim::CondTimedWait>("pthread_cond_timedwait");
  if (!shim::turn().holds()) {
    return function(condition, mutex, deadline);
  }
  return shim::waitOnUntil(condition, mutex, shim::clockOf(*condition), *deadline);
}

int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                           const timespec* deadline) {
  static shim::CondClockWait* const function =
      shim::real<shim::CondClockWait>("pthread_cond_clockwait");
  if (!shim::turn().holds()) {
    return function(condition, mutex, clock, deadline);
  }
  return shim::waitOnUntil(condition, mutex, clock, *deadline);
}

int pthread_cond_signal(pthread_cond_t* condition) {
  static shim::CondSignal* const function = shim::real<shim::CondSignal>("pthread_cond_signal");
  shim::turn().signal(condition, false);
  return function(condition);
}

int pthread_cond_broadcast(pthread_cond_t* condition) {
  static shim::CondSignal* const function = shim::real<shim::CondSignal>("pthread_cond_broadcast");
  shim::turn().signal(condition, true);
  return function(condition);
}

// ---- sleeps and clocks of the wall -----------------------------------------------------------

int nanosleep(const timespec* request, timespec* rest) {
  static shim::NanoSleep* const function = shim::realNanosleep();
  if (!shim::turn().holds()) {
    return function(request, rest);
  }
  shim::sleepWall(shim::toNs(*request), *request, function);
  return 0;
}

int clock_nanosleep(clockid_t clock, int flags, const timespec* request, timespec* rest) {
  using ClockNanosleep = int(clockid_t, int, const timespec*, timespec*);
  static ClockNanosleep* const function = shim::real<ClockNanosleep>("clock_nanosleep");
  if (!shim::turn().holds()) {
    return function(clock, flags, request, rest);
  }
  const bool is_absolute = (flags & TIMER_ABSTIME) != 0;
  const std::int64_t duration =
      is_absolute ? shim::remaining(clock, *request) : shim::toNs(*request);
  if (duration > 0) {
    shim::sleepWall(duration, shim::toTimespec(duration), shim::realNanosleep());
  }
  return 0;
}

int usleep(useconds_t microseconds) {
  const timespec request = shim::toTimespec(static_cast<std::int64_t>(microseconds) * 1000);
  return nanosleep(&request, nullptr);
}

unsigned sleep(unsigned seconds) {
  const timespec request{static_cast<time_t>(seconds), 0};
  return nanosleep(&request, nullptr) == 0 ? 0 : seconds;
}

int sched_yield() {
  using Yield = int();
  static Yield* const function = shim::real<Yield>("sched_yield");
  if (!shim::turn().holds()) {
    return function();
  }
  shim::Wait wait;
  wait.next_round = true;
  shim::turn().wait(std::move(wait));
  return 0;
}

int clock_gettime(clockid_t clock, timespec* time) {
  if ((clock != CLOCK_REALTIME && clock != CLOCK_MONOTONIC) || !shim::turn().holds()) {
    return shim::realGetTime()(clock, time);
  }
  *time = shim::toTimespec(shim::readSeen(clock, 1));
  return 0;
}

int gettimeofday(timeval* time, void* zone) {
  using GetTimeOfDay = int(timeval*, void*);
  static GetTimeOfDay* const function = shim::real<GetTimeOfDay>("gettimeofday");
  if (!shim::turn().holds()) {
    return function(time, zone);
  }
  constexpr std::int64_t kMicrosecond = 1000;
  const timespec now = shim::toTimespec(shim::readSeen(CLOCK_REALTIME, kMicrosecond));
  *time = {now.tv_sec, now.tv_nsec / kMicrosecond};
  return 0;
}

}  // extern "C"
#pragma GCC visibility pop
