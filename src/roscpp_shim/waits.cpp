// The waits of roscpp programs: for times, for callback queues, in spinners.
#include "waits.h"

#include <ros/callback_queue.h>
#include <ros/init.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <ros/subscribe_options.h>
#include <ros/this_node.h>
#include <ros/topic_manager.h>
#include <time.h>

#include "delivery.h"
#include "followed.h"
#include "node.h"
#include "roscpp_shim/machine/real.h"
#include "turn.h"

namespace ros {
CallbackQueuePtr getInternalCallbackQueue();  // exported by roscpp, but in none of its headers
}

namespace move_base_abstract::shim {
namespace {

constexpr unsigned kIdlePolls = 3;      // waits in vain, after which a loop is one that waits
constexpr unsigned kEmptyPolls = 1000;  // looks in vain, after which simulated time goes on

unsigned spinner_stops = 0;  // number of calls that stopped an AsyncSpinner
StoringLoops is_storing_loop = nullptr;

/** @brief Access to the private members of a callback queue. */
struct OpenQueue : public ros::CallbackQueue {
  /** @return the first callback, or null. (isEmpty() also counts callbacks that run now.) */
  static const ros::CallbackInterface* first(ros::CallbackQueue& queue) {
    const boost::mutex::scoped_lock lock(queue.*(&OpenQueue::mutex_));
    const auto& callbacks = queue.*(&OpenQueue::callbacks_);
    return callbacks.empty() ? nullptr : callbacks.front().callback.get();
  }
  static std::size_t size(ros::CallbackQueue& queue) {
    const boost::mutex::scoped_lock lock(queue.*(&OpenQueue::mutex_));
    return (queue.*(&OpenQueue::callbacks_)).size();
  }
};

bool isInternalQueue(const ros::CallbackQueue* queue) {
  static const ros::CallbackQueue* const internal = ros::getInternalCallbackQueue().get();
  return queue == internal;
}

/**
 * @brief Make a wait without a round for each time-out, for a thread that only looks at its queue.
 *
 * Anything else that it may look at changes only when another thread has run. After that, and after
 * its time-out, it looks with the next round of this program; if there is none, in one of its own.
 * A storing loop looks only while a thread waits for another one.
 */
void awaitActivity(bool is_storing, Nanoseconds timeout, Wait* wait) {
  wait->until = kNever;
  wait->activity = true;
  wait->activity_from = is_storing ? kNever : node().now() + timeout;
  wait->activity_by = is_storing ? kNever : wait->activity_from + timeout;
}

/** @brief Wait for a callback, for at most @p timeout. @return whether there is one in the queue.
 */
bool awaitCallback(ros::CallbackQueue& queue, const ros::WallDuration& timeout,
                   const void* caller) {
  Task& me = *Turn::self();
  if (OpenQueue::first(queue) != nullptr) {
    me.empty_polls = 0;
    return true;
  }
  if (timeout.isZero()) {
    countLook(&me.empty_polls, kEmptyPolls);
    return OpenQueue::first(queue) != nullptr;
  }
  // A loop around this wait that does nothing else needs no round for each time-out.
  me.idle_polls = me.has_acted ? 0 : me.idle_polls;
  Wait wait;
  wait.until = me.in_spinner ? kNever : node().now() + timeout.toNSec();
  const bool is_storing = !me.in_spinner && is_storing_loop != nullptr && is_storing_loop(caller);
  if (is_storing) {
    storeFrom(&queue);
  } else {
    noteWait(&queue);
  }
  if (is_storing || (!me.in_spinner && me.idle_polls >= kIdlePolls)) {
    awaitActivity(is_storing, timeout.toNSec(), &wait);
  }
  wait.is_over = [&queue, stops = spinner_stops] {
    return OpenQueue::first(queue) != nullptr || spinner_stops != stops;
  };
  wait.queue = &queue;
  wait.is_in_pool = me.in_spinner;
  const Woken woken = turn().wait(wait);
  me.idle_polls += woken == Woken::kReady ? 0 : 1;
  me.has_acted = false;
  return woken == Woken::kReady;
}

/** @brief Marks that callbacks run: the thread's waits are the program's own, not the spinner's. */
class InCallbacks {
 public:
  explicit InCallbacks(Task& task)
      : task_(task), was_(task.in_spinner), has_acted_(task.has_acted) {
    task.in_spinner = false;
    ++task.in_callbacks;
  }
  ~InCallbacks() {
    task_.in_spinner = was_;
    task_.has_acted = has_acted_;
    --task_.in_callbacks;
  }

 private:
  Task& task_;
  bool was_;
  bool has_acted_;
};

/** @brief Marks the waits of a spinner's loop. */
class InSpinner {
 public:
  InSpinner() : task_(turn().enter() ? Turn::self() : nullptr) {
    if (task_ != nullptr) {
      was_ = task_->in_spinner;
      task_->in_spinner = true;
    }
  }
  ~InSpinner() {
    if (task_ != nullptr) {
      task_->in_spinner = was_;
    }
  }

 private:
  Task* task_;
  bool was_ = false;
};

/** @brief Wait after callbacks were put back, because other threads run them. It ends when that may
 * have changed. */
void awaitOthers(ros::CallbackQueue& queue) {
  noteWait(&queue);
  Wait wait;
  wait.activity = true;
  wait.is_over = [&queue, size = OpenQueue::size(queue)] { return OpenQueue::size(queue) != size; };
  turn().wait(wait);
}

/**
 * @brief Wait until the node has shut down, since the run has ended in a sleep: how often a loop
 * goes round after that is no matter of chance. A shutdown may itself wait for this thread, if it
 * answers a service: then this gives up after a second.
 */
void awaitShutdown() {
  static auto* const function = real(&::nanosleep, "nanosleep");
  constexpr timespec kLook{0, 1'000'000};
  constexpr int kLooks = 5000, kLooksAtShutdown = 1000;
  for (int looks = 0, at_shutdown = 0;
       ros::ok() && looks < kLooks && at_shutdown < kLooksAtShutdown; ++looks) {
    at_shutdown += ros::isShuttingDown() ? 1 : 0;
    function(&kLook, nullptr);
  }
}

}  // namespace

bool sleepUntil(Nanoseconds until) {
  Task& me = *Turn::self();
  me.has_acted = true;
  if (until <= node().now()) {
    countLook(&me.empty_polls, kEmptyPolls);
    return takesPart();
  }
  me.empty_polls = 0;
  Wait wait;
  wait.until = until;
  if (turn().wait(wait) != Woken::kEnd) {
    return true;
  }
  awaitShutdown();
  return false;
}

void setStoringLoops(StoringLoops is_storing) { is_storing_loop = is_storing; }

void passTime(const char* call) {
  tellPassage(call);
  Wait wait;
  wait.until = node().now() + kPassage;
  turn().wait(std::move(wait));
}

void countClockRead() {
  unsigned& reads = Turn::self()->clock_reads;
  if (++reads >= kClockReads) {
    passTime("a clock");
    reads = kClockReads - kClockReadsAgain;  // any other wait begins the count anew
  }
}

bool countRepeated(Repeated* done, unsigned limit, Nanoseconds slack, const char* call) {
  const bool is_in_row = done->at >= 0 && node().now() <= done->at + slack;
  done->count = is_in_row ? done->count + 1 : 1;
  const bool takes_time = done->count > limit;
  if (takes_time) {
    passTime(call);
  }
  done->at = node().now();
  return takes_time;
}

void countLook(unsigned* count, unsigned limit) {
  if (++*count >= limit) {
    *count = 0;
    passTime("a queue, a sleep or a lock");
  }
}

Woken awaitCondition(const void* object, std::function<bool()> is_over, Nanoseconds lasts,
                     const char* what, const Task* end_of) {
  Task& me = *Turn::self();
  if (lasts <= 0) {
    countLook(&me.empty_polls, kEmptyPolls);
    return is_over() ? Woken::kReady : Woken::kTime;
  }
  me.has_acted = true;
  me.empty_polls = 0;
  Wait wait;
  wait.object = object;
  wait.is_over = std::move(is_over);
  wait.until = lasts == kNever ? kNever : node().now() + lasts;
  wait.for_thread = lasts == kNever;
  wait.what = what;
  wait.is_owed = end_of == nullptr;
  wait.end_of = end_of;
  return turn().wait(std::move(wait));
}

}  // namespace move_base_abstract::shim

namespace ros {

// ---- time ------------------------------------------------------------------------------------

void Time::setNow(const Time& now) {
  static auto* const function = shim::real(&Time::setNow, "ros::Time::setNow");
  if (!shim::takesPart()) {  // otherwise grants set the time
    function(now);
  }
}

Time Time::now() {
  static auto* const function = shim::real(&Time::now, "ros::Time::now");
  if (shim::turn().holds()) {
    shim::Turn::self()->has_acted = true;
    shim::countClockRead();
  }
  return function();
}

bool Duration::sleep() const {
  static auto* const function = shim::real(&Duration::sleep, "ros::Duration::sleep");
  if (!shim::turn().enter()) {
    return function(this);
  }
  return shim::sleepUntil(shim::node().now() + toNSec());
}

bool Time::sleepUntil(const Time& end) {
  static auto* const function = shim::real(&Time::sleepUntil, "ros::Time::sleepUntil");
  if (!shim::turn().enter()) {
    return function(end);
  }
  return shim::sleepUntil(static_cast<std::int64_t>(end.toNSec()));
}

// ---- callback queues -------------------------------------------------------------------------

void CallbackQueue::callAvailable(WallDuration timeout) {
  static auto* const function =
      shim::real<void(CallbackQueue*, WallDuration)>("ros::CallbackQueue::callAvailable");
  if (shim::isInternalQueue(this) || !shim::turn().enter()) {
    function(this, timeout);
    return;
  }
  if (!shim::awaitCallback(*this, timeout, __builtin_return_address(0))) {
    return;
  }
  const CallbackInterface* const first = shim::OpenQueue::first(*this);
  {
    const shim::InCallbacks callbacks(*shim::Turn::self());
    function(this, WallDuration());
  }
  if (first != nullptr && shim::OpenQueue::first(*this) == first && shim::turn().enter()) {
    shim::Wait wait;  // it was put back, or came again: let the other threads go first
    wait.next_round = true;
    shim::turn().wait(wait);
  }
}

CallbackQueue::CallOneResult CallbackQueue::callOne(WallDuration timeout) {
  static auto* const function =
      shim::real<CallOneResult(CallbackQueue*, WallDuration)>("ros::CallbackQueue::callOne");
  if (shim::isInternalQueue(this) || !shim::turn().enter()) {
    return function(this, timeout);
  }
  if (!shim::awaitCallback(*this, timeout, __builtin_return_address(0))) {
    return isEnabled() ? Empty : Disabled;
  }
  CallOneResult result = TryAgain;
  // A callback that another thread runs goes to the end of the queue. The next one may be free.
  for (std::size_t left = shim::OpenQueue::size(*this); result == TryAgain && left > 0; --left) {
    const shim::InCallbacks callbacks(*shim::Turn::self());
    result = function(this, WallDuration());
  }
  if (result == TryAgain && shim::turn().enter()) {
    shim::awaitOthers(*this);
  }
  return result;
}

void CallbackQueue::addCallback(const CallbackInterfacePtr& callback, uint64_t owner) {
  static auto* const function =
      shim::real(&CallbackQueue::addCallback, "ros::CallbackQueue::addCallback");
  const bool is_outside = shim::takesPart() && shim::Turn::self() == nullptr;
  if (!is_outside || shim::isInternalQueue(this)) {
    function(this, callback, owner);
    return;
  }
  shim::Input input;
  input.enter = [this, callback, owner] { function(this, callback, owner); };
  input.label =
      "a call or a connection has reached " + this_node::getName() + " from outside of lockstep";
  input.queue = this;
  input.owner = owner;
  shim::node().fromOutside(std::move(input));
}

void CallbackQueue::removeByID(uint64_t owner) {
  static auto* const function =
      shim::real(&CallbackQueue::removeByID, "ros::CallbackQueue::removeByID");
  if (shim::takesPart()) {
    shim::node().removeOutside(this, owner);
  }
  function(this, owner);
}

// ---- spinners --------------------------------------------------------------------------------

void SingleThreadedSpinner::spin(CallbackQueue* queue) {
  static auto* const function =
      shim::real(&SingleThreadedSpinner::spin, "ros::SingleThreadedSpinner::spin");
  const shim::InSpinner spinner;
  function(this, queue);
}

/** A class of roscpp, which no header declares. */
class ROSCPP_DECL AsyncSpinnerImpl {
  void threadFunc();
  void stop();
};

void AsyncSpinnerImpl::stop() {
  static auto* const function = shim::real(&AsyncSpinnerImpl::stop, "ros::AsyncSpinnerImpl::stop");
  ++shim::spinner_stops;  // seen when this thread waits for the others to end
  function(this);
}

void AsyncSpinnerImpl::threadFunc() {
  static auto* const function =
      shim::real(&AsyncSpinnerImpl::threadFunc, "ros::AsyncSpinnerImpl::threadFunc");
  const shim::InSpinner spinner;
  function(this);
}

}  // namespace ros
