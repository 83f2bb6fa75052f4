#include "turn.h"

#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <mutex>
#include <thread>

#include "followed.h"
#include "hearing.h"
#include "kernel.h"
#include "node.h"
#include "real.h"

// A thread's variables lie where no allocation is needed to find them: locks are taken early.
#define MOVE_BASE_ABSTRACT_FAST_TLS __attribute__((tls_model("initial-exec")))

namespace move_base_abstract::shim {
namespace {

using Lock = std::lock_guard<PlainMutex>;
using MutexFunction = int(pthread_mutex_t*);

constexpr auto kWatchPeriod = std::chrono::milliseconds(100);  // wall
constexpr int kStuckPeriods = 3;

thread_local Task* t_task MOVE_BASE_ABSTRACT_FAST_TLS = nullptr;
thread_local int t_inside MOVE_BASE_ABSTRACT_FAST_TLS = 0;
thread_local bool t_internal MOVE_BASE_ABSTRACT_FAST_TLS = false;

/** The semaphores of this library are libc's own: not those that hand the turn over. */
void awake(Task* task) {
  static auto* const post = real<int(sem_t*)>("sem_post");
  post(&task->go);
}

int awaitGo(Task* task) {
  static auto* const wait = real<int(sem_t*)>("sem_wait");
  return wait(&task->go);
}

}  // namespace

void PlainMutex::lock() {
  static MutexFunction* const lock_mutex = real<MutexFunction>("pthread_mutex_lock");
  lock_mutex(&mutex_);
}

void PlainMutex::unlock() { pthread_mutex_unlock(&mutex_); }

Inside::Inside() { ++t_inside; }
Inside::~Inside() { --t_inside; }

Blocking::Blocking() {
  if (t_task != nullptr) {
    t_task->is_blocking = true;
  }
}

Blocking::~Blocking() {
  if (t_task != nullptr) {
    t_task->is_blocking = false;
  }
}

Turn& turn() {
  static Turn* const instance = new Turn;  // threads use it until the process has gone
  return *instance;
}

Task* Turn::self() { return t_task; }
bool Turn::isInside() { return t_inside > 0; }
bool Turn::isInternal() { return t_internal; }
void Turn::becomeInternal() { t_internal = true; }

// ---- threads ---------------------------------------------------------------------------------

Task* Turn::create(std::function<void*()> main) {
  auto* const task = new Task;
  static auto* const init = real<int(sem_t*, int, unsigned)>("sem_init");
  init(&task->go, 0, 0);
  task->main = std::move(main);
  if (task->main) {
    const Lock lock(mutex_);
    task->is_waiting = true;
    task->wait.until = 0;  // as soon as the others wait
    tasks_.push_back(task);
    waiting_.push_back(task);
  }
  return task;
}

void Turn::begin() {
  Task* const task = create(nullptr);
  task->thread = pthread_self();
  task->tid = static_cast<int>(::syscall(SYS_gettid));
  t_task = task;
  tasks_.push_back(task);
  holder_ = task;
  is_active_ = true;
  const Inside inside;
  std::thread([this] {
    becomeInternal();
    watch();
  }).detach();
}

void* Turn::run(Task* task) {
  struct Finisher {
    ~Finisher() {  // pthread_exit comes here too
      turn->finish(task);
      t_task = nullptr;
    }
    Turn* turn;
    Task* task;
  };
  task->tid = static_cast<int>(::syscall(SYS_gettid));
  t_task = task;
  const Finisher finisher{this, task};
  park(task);
  const auto main = std::move(task->main);
  return main();
}

void Turn::finish(Task* task) {
  task->is_done = true;
  forgetListener(task->listened);
  if (!isActive() || task->is_loose) {
    return;
  }
  const Inside inside;
  if (Task* const next = firstReady()) {
    handOver(next);
    return;
  }
  const Lock lock(mutex_);
  ++activity_;
  // Somebody else must report, since this thread goes; or who comes back next (see regain).
  holder_ = waiting_.empty() ? nullptr : waiting_.front();
  if (holder_ != nullptr) {
    awake(holder_);
  }
}

Task* Turn::adopt() {
  node().label("a thread was started before ROS was");
  Task* const task = create(nullptr);
  task->thread = pthread_self();
  task->tid = static_cast<int>(::syscall(SYS_gettid));
  task->is_loose = true;
  t_task = task;
  const Lock lock(mutex_);
  tasks_.push_back(task);
  return task;
}

Task* Turn::find(pthread_t thread) {
  const Lock lock(mutex_);
  const auto found = std::find_if(tasks_.rbegin(), tasks_.rend(), [thread](const Task* task) {
    return pthread_equal(task->thread, thread) != 0;
  });
  return found == tasks_.rend() ? nullptr : *found;
}

int Turn::holder() {
  const Lock lock(mutex_);
  return holder_ == nullptr ? 0 : holder_->tid;
}

bool Turn::isParked(int tid) {
  const Lock lock(mutex_);
  return std::any_of(waiting_.begin(), waiting_.end(),
                     [tid](const Task* task) { return task->tid == tid; });
}

bool Turn::holds() {
  if (!isActive() || t_task == nullptr || t_inside > 0) {
    return false;
  }
  if (t_task->is_loose) {
    regain(t_task);
  }
  return isActive();
}

bool Turn::enter() {
  if (!isActive() || t_internal || t_inside > 0) {
    return false;
  }
  if (t_task == nullptr) {
    adopt();
  }
  return holds();
}

void Turn::regain(Task* task) {
  {
    const Lock lock(mutex_);
    task->wait = Wait();
    task->wait.until = 0;
    task->is_signalled = true;
    task->is_waiting = true;
    waiting_.push_back(task);
    if (holder_ == nullptr) {
      holder_ = task;
      awake(task);
    }
  }
  node().ring();
  park(task);
  task->is_loose = false;
}

// ---- waiting ---------------------------------------------------------------------------------

Woken Turn::wait(Wait wait) {
  const Inside inside;
  Task* const me = t_task;
  if (wait.next_round) {
    const auto round = node().round();
    wait.is_over = [round] { return node().round() != round; };
  } else if (wait.at_rest) {
    wait.is_over = [round = node().round()] { return node().restRound() > round; };
  }
  while (!enlist(me, wait)) {
    regain(me);
  }
  if (me->wait.unlock) {
    me->wait.unlock();
  }
  while (me->is_waiting && isActive()) {
    Task* const next = firstReady();
    if (next == nullptr) {
      node().exchange();
    } else if (handOver(next); next != me) {
      park(me);
    }
  }
  if (!isActive()) {
    return Woken::kEnd;
  }
  me->clock_reads = 0;
  const bool is_over = me->is_signalled || (me->wait.is_over && me->wait.is_over());
  return is_over ? Woken::kReady : Woken::kTime;
}

bool Turn::enlist(Task* task, Wait& wait) {
  const Lock lock(mutex_);
  if (task->is_loose) {
    return false;
  }
  task->wait = std::move(wait);
  task->is_signalled = false;
  task->is_waiting = true;
  task->seen_activity = activity_;
  waits_for_threads_ += task->wait.for_thread ? 1 : 0;
  waiting_.push_back(task);
  return true;
}

void Turn::park(Task* task) {
  const Inside inside;
  while (isActive() && awaitGo(task) != 0 && errno == EINTR) {
  }
  // Woken without being chosen: everybody waits, and this thread is to report for them.
  while (task->is_waiting && isActive()) {
    Task* const next = firstReady();
    if (next == nullptr) {
      node().exchange();
    } else if (handOver(next); next != task) {
      while (isActive() && awaitGo(task) != 0 && errno == EINTR) {
      }
    }
  }
}

bool Turn::isReady(const Task& task, bool* by_activity) const {
  if (task.is_signalled || (task.wait.is_over && task.wait.is_over()) ||
      (!task.wait.next_round && node().now() >= task.wait.until)) {
    return true;
  }
  *by_activity = task.wait.activity && task.seen_activity != activity_ &&
                 (waits_for_threads_ > 0 || node().now() >= task.wait.activity_from);
  return *by_activity;
}

Task* Turn::firstReady() {
  std::vector<Task*> waiting;
  {
    const Lock lock(mutex_);
    waiting = waiting_;
  }
  // Not under the lock: what is_over looks at may itself be locked by one who signals.
  for (Task* const task : waiting) {
    bool by_activity = false;
    if (isReady(*task, &by_activity)) {
      const Lock lock(mutex_);
      activity_ += by_activity ? 0 : 1;
      // Of a pool the one that is here: no other thread need be woken.
      const bool is_ours = task->wait.pool != nullptr && t_task != nullptr && t_task->is_waiting &&
                           t_task->wait.pool == task->wait.pool && isReady(*t_task, &by_activity);
      return is_ours ? t_task : task;
    }
  }
  return nullptr;
}

void Turn::handOver(Task* next) {
  {
    const Lock lock(mutex_);
    waiting_.erase(std::find(waiting_.begin(), waiting_.end(), next));
    waits_for_threads_ -= next->wait.for_thread ? 1 : 0;
    next->is_waiting = false;
    next->seen_activity = activity_;
    holder_ = next;
    ++switches_;
  }
  if (next != t_task) {
    awake(next);
  }
}

void Turn::signal(const void* object, bool all) {
  if (!isActive()) {
    return;
  }
  const Inside inside;
  bool is_woken = false;
  {
    const Lock lock(mutex_);
    for (Task* const task : waiting_) {
      if (task->wait.object == object && !task->is_signalled && (all || !is_woken)) {
        task->is_signalled = true;
        is_woken = true;
      }
    }
  }
  if (is_woken && t_task == nullptr) {
    if (!t_internal && !isWorkerPool(nullptr)) {
      node().label("a thread that lockstep does not order has woken another one");
    }
    node().ring();
  }
}

bool Turn::isResting() {
  const Lock lock(mutex_);
  return std::any_of(waiting_.begin(), waiting_.end(),
                     [](const Task* task) { return task->wait.at_rest; });
}

Nanoseconds Turn::nextWake() {
  const Lock lock(mutex_);
  Nanoseconds next = kNever;
  for (const Task* task : waiting_) {
    const bool looks = task->wait.activity && task->seen_activity != activity_;
    next = std::min({next, task->wait.next_round ? node().now() : task->wait.until,
                     looks ? task->wait.activity_by : kNever});
  }
  return next;
}

bool Turn::hasGuest() {
  const Lock lock(mutex_);
  return std::any_of(waiting_.begin(), waiting_.end(),
                     [](const Task* task) { return task->is_signalled; });
}

void Turn::end() {
  is_active_ = false;
  const Lock lock(mutex_);
  for (Task* const task : tasks_) {
    awake(task);
  }
}

/** Lets others run beside a thread that blocks where this library does not see it. */
void Turn::watch() {
  std::uint64_t switches = 0;
  int stuck = 0;
  while (isActive()) {
    std::this_thread::sleep_for(kWatchPeriod);
    const Lock lock(mutex_);
    const bool may_be_stuck = switches == switches_ && holder_ != nullptr && !holder_->is_waiting &&
                              !holder_->is_blocking && !holder_->is_loose && !waiting_.empty();
    switches = switches_;
    stuck = may_be_stuck && isAsleep(holder_->tid) ? stuck + 1 : 0;
    if (stuck >= kStuckPeriods && !waitsForReader()) {
      holder_->is_loose = true;
      holder_ = waiting_.front();
      awake(holder_);
      node().label("a thread waits for another one in a way that lockstep does not follow");
    }
  }
}

}  // namespace move_base_abstract::shim
