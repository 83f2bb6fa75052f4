// The program's threads: how they begin and end, and what each knows about itself.
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "followed.h"
#include "node.h"
#include "roscpp_shim/machine/kernel.h"
#include "roscpp_shim/machine/real.h"
#include "turn.h"

namespace move_base_abstract::shim {

__thread TurnLocal t_local = {nullptr, 0, 0, 0, false, 0};

namespace {

using Lock = std::lock_guard<PlainMutex>;

/** For allocations, which cannot ask turn(): turn() itself allocates. */
enum class Phase { kBefore, kActive, kOver };
std::atomic<Phase> phase{Phase::kBefore};

/** Let gdb attach where the kernel lets a process be looked at by its parents alone. */
void letDebuggersIn() {
  if (std::getenv("MOVE_BASE_ABSTRACT_DEBUG") != nullptr) {
    ::prctl(PR_SET_PTRACER, PR_SET_PTRACER_ANY, 0, 0, 0);
  }
}

int ownTid() { return static_cast<int>(askKernel(SYS_gettid)); }

bool isInFirstThread() {
  if (t_local.first == 0) {
    t_local.first = ownTid() == static_cast<int>(askKernel(SYS_getpid)) ? 1 : -1;
  }
  return t_local.first > 0;
}

}  // namespace

void PlainMutex::lock() {
  static auto* const lock_mutex = real(&::pthread_mutex_lock, "pthread_mutex_lock");
  lock_mutex(&mutex_);
}

void PlainMutex::unlock() { pthread_mutex_unlock(&mutex_); }

Turn& turn() {
  static Turn* const instance = [] {
    const Beside beside;
    return new Turn;  // threads use it until the process has gone
  }();
  return *instance;
}

// ---- what a thread knows about itself --------------------------------------------------------

Blocking::Blocking() {
  if (t_local.task != nullptr) {
    t_local.task->is_blocking = true;
  }
}

Blocking::~Blocking() {
  if (t_local.task != nullptr) {
    t_local.task->is_blocking = false;
  }
}

Task* Turn::self() { return t_local.task; }
bool Turn::isInside() { return t_local.inside > 0; }
bool Turn::isInternal() { return t_local.is_internal; }
bool Turn::startsInternal() { return isInternal() || isInside() || t_local.starts > 0; }
void Turn::becomeInternal() { t_local.is_internal = true; }

void Turn::atEnd(std::function<void()> function) {
  t_local.task->at_end.push_back(std::move(function));
}

bool Turn::freesInOrder() {
  switch (phase.load(std::memory_order_relaxed)) {
    case Phase::kBefore:
      return isInFirstThread();
    case Phase::kActive:
      return t_local.task != nullptr && !t_local.task->is_loose;
    default:
      return true;  // no thread allocates in order any more
  }
}

bool Turn::allocatesInOrder() {
  return t_local.inside == 0 && t_local.beside == 0 &&
         phase.load(std::memory_order_relaxed) != Phase::kOver && hasOrderedAddresses() &&
         freesInOrder();
}

// ---- beginning and end -----------------------------------------------------------------------

void Turn::begin() {
  const Inside inside;
  ends_.prepare();
  const auto task = create(nullptr);
  task->thread = pthread_self();
  task->tid = ownTid();
  t_local.task = task.get();
  tasks_.push_back(task);
  holder_ = task.get();
  is_active_ = true;
  phase = Phase::kActive;
  letDebuggersIn();
  std::thread([this] {
    becomeInternal();
    pthread_setname_np(pthread_self(), "lockstep_watch");
    watch();
  }).detach();
}

void Turn::end() {
  is_active_ = false;
  phase = Phase::kOver;
  const Lock lock(mutex_);
  for (const auto& task : tasks_) {
    task->sleeper->call();
  }
}

std::shared_ptr<Task> Turn::create(std::function<void*()> main) {
  const Inside inside;
  const auto task = std::make_shared<Task>();
  task->main = std::move(main);
  const Lock lock(mutex_);
  takePlace(task.get());
  if (task->main) {
    task->is_waiting = true;
    task->wait.until = 0;  // as soon as the others wait
    tasks_.push_back(task);
    waiting_.push_back(task.get());
  }
  return task;
}

/** @brief Let @p task sleep where the time master can wake it, if there is a place left. */
void Turn::takePlace(Task* task) {
  SharedChannel* const channel = node().membership().channel();
  const auto free = std::find(places_.begin(), places_.end(), false);
  if (channel != nullptr && free != places_.end()) {
    *free = true;
    task->place.number = static_cast<std::uint32_t>(free - places_.begin());
    task->sleeper = &channel->sleeper(task->place.number);
    task->place.seen = task->sleeper->calls();
  }
}

void Turn::discard(const std::shared_ptr<Task>& task) {
  const Lock lock(mutex_);
  waiting_.erase(std::remove(waiting_.begin(), waiting_.end(), task.get()), waiting_.end());
  forget(task.get());
}

void Turn::forget(const Task* task) {
  places_[task->place.number] = task->place.number == 0;
  tasks_.erase(std::remove_if(tasks_.begin(), tasks_.end(),
                              [task](const auto& one) { return one.get() == task; }),
               tasks_.end());
}

void* Turn::run(Task* task) {
  task->tid = ownTid();
  t_local.task = task;
  ends_.await();
  await(task, false);
  const auto main = std::move(task->main);
  return main();
}

void Turn::Ends::prepare() { pthread_key_create(&key_, &Ends::onEnd); }

void Turn::Ends::await() { pthread_setspecific(key_, reinterpret_cast<void*>(1)); }

/** @param pass number of passes so far: destructors of thread_local objects and other keys come
 * first, while the thread still has the turn. */
void Turn::Ends::onEnd(void* pass) {
  constexpr std::uintptr_t kPasses = 3;  // of PTHREAD_DESTRUCTOR_ITERATIONS, 4
  const auto next = reinterpret_cast<std::uintptr_t>(pass) + 1;
  if (next <= kPasses) {
    pthread_setspecific(turn().ends_.key_, reinterpret_cast<void*>(next));
  } else {
    turn().finish(t_local.task);
  }
}

void Turn::finish(Task* task) {
  const Inside inside;
  task->is_done = true;
  task->wait = Wait();
  for (const auto& function : task->at_end) {
    function();
  }
  const bool hands_over = isActive() && !task->is_loose;
  latest_ = hands_over ? nullptr : latest_;
  Task* const next = hands_over ? firstReady() : nullptr;
  if (next != nullptr) {
    handOver(next);
  } else if (isActive() && task->is_loose) {
    tellEndOf(task);
  }
  t_local.task = nullptr;  // what it frees from here on has no order
  const Lock lock(mutex_);
  if (hands_over && next == nullptr) {
    ++activity_;
    // Another thread must report, since this one ends. If none waits, the next one that comes back
    // does (see regain).
    letAct(waiting_.empty() ? nullptr : waiting_.front());
  }
  forget(task);
}

/** @brief Let those that wait for the end of a thread that runs beside the others go on. */
void Turn::tellEndOf(const Task* task) {
  {
    const Lock lock(mutex_);
    for (Task* const one : waiting_) {
      one->is_signalled = one->is_signalled || one->wait.end_of == task;
    }
  }
  node().ring();
}

Task* Turn::adopt() {
  const Inside inside;
  node().label("a thread was started before ROS was");
  const auto task = create(nullptr);
  task->thread = pthread_self();
  task->tid = ownTid();
  task->is_loose = true;
  t_local.task = task.get();
  ends_.await();
  const Lock lock(mutex_);
  tasks_.push_back(task);
  return task.get();
}

std::shared_ptr<Task> Turn::find(pthread_t thread) {
  const Inside inside;
  const Lock lock(mutex_);
  const auto found = std::find_if(tasks_.rbegin(), tasks_.rend(), [thread](const auto& task) {
    return pthread_equal(task->thread, thread) != 0;
  });
  return found == tasks_.rend() ? nullptr : *found;
}

}  // namespace move_base_abstract::shim
