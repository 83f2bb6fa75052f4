// Where roscpp programs wait: time, callback queues, spinners.
#include "waits.h"

#include <ros/callback_queue.h>
#include <ros/init.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <ros/subscribe_options.h>
#include <ros/this_node.h>
#include <ros/topic_manager.h>

#include "interest.h"
#include "node.h"
#include "roscpp_shim/machine/real.h"
#include "turn.h"

namespace ros {
CallbackQueuePtr getInternalCallbackQueue();  // exported by roscpp, but in none of its headers
}

namespace move_base_abstract::shim {
namespace {

constexpr unsigned kIdlePolls = 3;         // waits in vain, after which a loop only waits
constexpr unsigned kEmptyPolls = 1000;     // looks in vain, after which simulated time goes on
constexpr unsigned kClockReads = 1000000;  // at one instant, after which it goes on
constexpr Nanoseconds kPollPeriod = 1'000'000;

unsigned spinner_stops = 0;  // how often an AsyncSpinner's threads were told to end
StoringLoops is_storing_loop = nullptr;

/** @brief Opens what a queue keeps to itself. */
struct OpenQueue : public ros::CallbackQueue {
  /** @return the first callback, if there is one. (isEmpty() counts those under way too.) */
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
 * @brief Wait without a round for each time-out: a thread that does nothing but look at its queue.
 *
 * What else it may look at changes only when another thread has run: then it looks too, when its
 * time-out is over, with whatever this program does from then on; on its own if that is nothing.
 * A storing loop looks only while somebody waits for another thread.
 */
void awaitActivity(bool is_storing, Nanoseconds timeout, Wait* wait) {
  wait->until = kNever;
  wait->activity = true;
  wait->activity_from = is_storing ? kNever : node().now() + timeout;
  wait->activity_by = is_storing ? kNever : wait->activity_from + timeout;
}

/** @return whether there is a callback in the queue; waits for one, for at most @p timeout. */
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
  // A loop around this wait that does nothing else is not worth a round for each time-out.
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
  wait.pool = me.in_spinner ? &queue : nullptr;
  const Woken woken = turn().wait(wait);
  me.idle_polls += woken == Woken::kReady ? 0 : 1;
  me.has_acted = false;
  return woken == Woken::kReady;
}

/** @brief While callbacks run, the thread's waits are the program's again, not its loop's. */
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
  InCallbacks(const InCallbacks&) = delete;
  InCallbacks& operator=(const InCallbacks&) = delete;

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
  InSpinner(const InSpinner&) = delete;
  InSpinner& operator=(const InSpinner&) = delete;

 private:
  Task* task_;
  bool was_ = false;
};

/** @brief Callbacks were put back, since other threads are in them: wait until that may change. */
void awaitOthers(ros::CallbackQueue& queue) {
  noteWait(&queue);
  Wait wait;
  wait.activity = true;
  wait.is_over = [&queue, size = OpenQueue::size(queue)] { return OpenQueue::size(queue) != size; };
  turn().wait(wait);
}

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
  return turn().wait(wait) != Woken::kEnd;
}

}  // namespace

void setStoringLoops(StoringLoops is_storing) { is_storing_loop = is_storing; }

void countLook(unsigned* count, unsigned limit) {
  if (++*count >= limit) {
    *count = 0;
    Wait wait;
    wait.until = node().now() + kPollPeriod;
    turn().wait(wait);
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

namespace shim = move_base_abstract::shim;

namespace ros {

// ---- time ------------------------------------------------------------------------------------

void Time::setNow(const Time& now) {
  using SetNow = void(const Time&);
  static SetNow* const function = shim::real<SetNow>("_ZN3ros4Time6setNowERKS0_");
  if (!shim::takesPart()) {  // else the grants say what time it is
    function(now);
  }
}

Time Time::now() {
  using Now = Time();
  static Now* const function = shim::real<Now>("_ZN3ros4Time3nowEv");
  if (shim::turn().holds()) {
    shim::Turn::self()->has_acted = true;
    shim::countLook(&shim::Turn::self()->clock_reads, shim::kClockReads);
  }
  return function();
}

bool Duration::sleep() const {
  using Sleep = bool(const Duration*);
  static Sleep* const function = shim::real<Sleep>("_ZNK3ros8Duration5sleepEv");
  if (!shim::turn().enter()) {
    return function(this);
  }
  return shim::sleepUntil(shim::node().now() + toNSec());
}

bool Time::sleepUntil(const Time& end) {
  using SleepUntil = bool(const Time&);
  static SleepUntil* const function = shim::real<SleepUntil>("_ZN3ros4Time10sleepUntilERKS0_");
  if (!shim::turn().enter()) {
    return function(end);
  }
  return shim::sleepUntil(static_cast<std::int64_t>(end.toNSec()));
}

// ---- callback queues -------------------------------------------------------------------------

void CallbackQueue::callAvailable(WallDuration timeout) {
  using CallAvailable = void(CallbackQueue*, WallDuration);
  static CallAvailable* const function =
      shim::real<CallAvailable>("_ZN3ros13CallbackQueue13callAvailableENS_12WallDurationE");
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
    shim::Wait wait;  // put back, or come again: let the others go first
    wait.next_round = true;
    shim::turn().wait(wait);
  }
}

CallbackQueue::CallOneResult CallbackQueue::callOne(WallDuration timeout) {
  using CallOne = CallOneResult(CallbackQueue*, WallDuration);
  static CallOne* const function =
      shim::real<CallOne>("_ZN3ros13CallbackQueue7callOneENS_12WallDurationE");
  if (shim::isInternalQueue(this) || !shim::turn().enter()) {
    return function(this, timeout);
  }
  if (!shim::awaitCallback(*this, timeout, __builtin_return_address(0))) {
    return isEnabled() ? Empty : Disabled;
  }
  CallOneResult result = TryAgain;
  // A callback that another thread is in goes to the end of the queue; the next may be free.
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
  using AddCallback = void(CallbackQueue*, const CallbackInterfacePtr&, uint64_t);
  static AddCallback* const function = shim::real<AddCallback>(
      "_ZN3ros13CallbackQueue11addCallbackERKN5boost10shared_ptrINS_17CallbackInterfaceEEEm");
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
  using RemoveById = void(CallbackQueue*, uint64_t);
  static RemoveById* const function =
      shim::real<RemoveById>("_ZN3ros13CallbackQueue10removeByIDEm");
  if (shim::takesPart()) {
    shim::node().removeOutside(this, owner);
  }
  function(this, owner);
}

// ---- spinners --------------------------------------------------------------------------------

void SingleThreadedSpinner::spin(CallbackQueue* queue) {
  using Spin = void(SingleThreadedSpinner*, CallbackQueue*);
  static Spin* const function =
      shim::real<Spin>("_ZN3ros21SingleThreadedSpinner4spinEPNS_13CallbackQueueE");
  const shim::InSpinner spinner;
  function(this, queue);
}

/** roscpp's, which it does not declare in a header. */
class ROSCPP_DECL AsyncSpinnerImpl {
  void threadFunc();
  void stop();
};

void AsyncSpinnerImpl::stop() {
  using Stop = void(AsyncSpinnerImpl*);
  static Stop* const function = shim::real<Stop>("_ZN3ros16AsyncSpinnerImpl4stopEv");
  ++shim::spinner_stops;  // seen when this thread waits for the others to end
  function(this);
}

void AsyncSpinnerImpl::threadFunc() {
  using ThreadFunction = void(AsyncSpinnerImpl*);
  static ThreadFunction* const function =
      shim::real<ThreadFunction>("_ZN3ros16AsyncSpinnerImpl10threadFuncEv");
  const shim::InSpinner spinner;
  function(this);
}

}  // namespace ros
