#include "turn.h"

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <tuple>

#include "followed.h"
#include "node.h"

namespace move_base_abstract::shim {
namespace {

using Lock = std::lock_guard<PlainMutex>;

/**
 * @return whether a waiting thread is owed what it waits for. A thread in a callback is in the
 * middle of its work. A thread that waits for the end of another one is owed what that one is owed.
 * In a circle of such waits no thread can end.
 */
bool isOwed(const Task& task) {
  std::vector<const Task*> seen;
  for (const Task* at = &task; at != nullptr; at = at->is_waiting ? at->wait.end_of : nullptr) {
    if (std::find(seen.begin(), seen.end(), at) != seen.end() ||
        (at->is_waiting && (at->wait.is_owed || at->in_callbacks > 0))) {
      return true;
    }
    seen.push_back(at);
  }
  return false;
}

}  // namespace

// ---- the turn --------------------------------------------------------------------------------

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
  if (!isActive() || t_local.task == nullptr || t_local.inside > 0) {
    return false;
  }
  if (t_local.task->is_loose) {
    regain(t_local.task);
  }
  return isActive();
}

bool Turn::enter() {
  if (!isActive() || t_local.is_internal || t_local.inside > 0) {
    return false;
  }
  if (t_local.task == nullptr) {
    adopt();
  }
  return holds();
}

void Turn::regain(Task* task) {
  const Inside inside;  // to ring wakes a futex, and that call asks whether the thread has the turn
  {
    const Lock lock(mutex_);
    task->wait = Wait();
    task->wait.until = 0;
    task->is_signalled = true;
    task->is_waiting = true;
    waiting_.push_back(task);
    if (holder_ == nullptr) {
      letAct(task);
    }
  }
  node().ring();
  await(task, false);
  task->is_loose = false;
}

// ---- waiting ---------------------------------------------------------------------------------

Woken Turn::wait(Wait wait) {
  const Inside inside;
  Task* const me = t_local.task;
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
  await(me, true);
  if (!isActive()) {
    return Woken::kEnd;
  }
  me->clock_reads = 0;
  me->yields = 0;
  me->tries = 0;
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
  latest_ = task;
  return true;
}

/** @brief Sleep until the turn comes to @p me. If it @p acts, it does what is to be done while all
 * wait: it reports for them, takes the grant, and chooses who goes on. */
void Turn::await(Task* me, bool acts) {
  const Inside inside;
  while (me->is_waiting && isActive()) {
    Task* const next = acts ? firstReady() : nullptr;
    if (next != nullptr) {
      handOver(next);
      acts = false;
      continue;
    }
    if (acts) {
      acts = node().exchange();
    } else {
      me->sleeper->sleep(me->place.seen, -1);
      me->place.seen = me->sleeper->calls();
      acts = this->acts();
    }
    // In both cases the time master may have woken it, and nobody else.
    acts = acts || (me->is_waiting && node().takeGrant());
  }
}

bool Turn::acts() {
  const Lock lock(mutex_);
  return holder_ == t_local.task;
}

void Turn::act() {
  const Lock lock(mutex_);
  holder_ = t_local.task;
}

/** @brief Let @p task act while all wait, and wake it. @pre The lock is held. */
void Turn::letAct(Task* task) {
  holder_ = latest_ = task;
  if (task != nullptr) {
    task->sleeper->call();
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
  {
    const Lock lock(mutex_);
    looked_at_ = waiting_;
  }
  // Not under the lock: a thread that signals may have locked what is_over looks at.
  for (Task* const task : looked_at_) {
    bool by_activity = false;
    if (isReady(*task, &by_activity)) {
      const Lock lock(mutex_);
      activity_ += by_activity ? 0 : 1;
      // Of a pool this thread goes on, if it can: then no other thread has to be woken.
      // (The latest one: which thread acts for all depends on the machine.)
      const bool is_ours = task->wait.is_in_pool && isLatestInPool(task->wait.queue) &&
                           isReady(*latest_, &by_activity);
      return is_ours ? latest_ : task;
    }
  }
  return nullptr;
}

bool Turn::isLatestInPool(const void* queue) const {
  return latest_ != nullptr && latest_->is_waiting && latest_->wait.is_in_pool &&
         latest_->wait.queue == queue;
}

std::uint8_t Turn::numberOf(const void* queue) {
  constexpr std::size_t kNumbers = std::tuple_size_v<decltype(Directions::thread_of_queue)> - 1;
  return queue == nullptr ? 0
                          : static_cast<std::uint8_t>(1 + reinterpret_cast<std::uintptr_t>(queue) /
                                                              alignof(std::max_align_t) % kNumbers);
}

void Turn::direct(Nanoseconds next, Directions* directions) {
  const Lock lock(mutex_);
  for (auto& thread : directions->thread_of_queue) {
    thread.store(0, std::memory_order_relaxed);
  }
  directions->thread_at_wake = 0;
  if (t_local.task->place.number == 0) {
    return;  // no other thread can wake this one while it waits for the grant
  }
  // As firstReady() chooses: the first one that waits, but the latest one of a pool.
  for (auto task = waiting_.rbegin(); task != waiting_.rend(); ++task) {
    const Wait& wait = (*task)->wait;
    const auto place = static_cast<std::uint8_t>((*task)->place.number);
    if (wait.until == next && next != kNever) {
      directions->thread_at_wake = place;
    }
    if (wait.queue != nullptr) {
      directions->thread_of_queue[numberOf(wait.queue)] =
          isLatestInPool(wait.queue) ? static_cast<std::uint8_t>(latest_->place.number) : place;
    }
  }
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
  if (next != t_local.task) {
    next->sleeper->call();
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
  if (is_woken && t_local.task == nullptr) {
    if (!t_local.is_internal && !isWorkerPool(nullptr)) {
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

Nanoseconds Turn::firstLook() {
  const Lock lock(mutex_);
  Nanoseconds first = kNever;
  for (const Task* task : waiting_) {
    if (task->wait.activity && task->seen_activity != activity_) {
      first = std::min(first, task->wait.activity_from);
    }
  }
  return first;
}

OpenWaits Turn::openWaits() {
  const Lock lock(mutex_);
  OpenWaits waits;
  for (const Task* task : waiting_) {
    if (task->wait.what != nullptr && task->wait.until == kNever) {
      (isOwed(*task) ? waits.owed : waits.work).emplace_back(task->wait.what);
    }
  }
  return waits;
}

const char* Turn::guest() {
  const Lock lock(mutex_);
  const auto at = std::find_if(waiting_.begin(), waiting_.end(),
                               [](const Task* task) { return task->is_signalled; });
  if (at == waiting_.end() || (*at)->is_loose) {
    return at == waiting_.end() ? nullptr : "";
  }
  return (*at)->wait.what == nullptr ? "its turn" : (*at)->wait.what;
}

}  // namespace move_base_abstract::shim
