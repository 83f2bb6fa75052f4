// Which messages a program wants at once.
//
// A queue on which no thread has ever waited is looked at by threads that go on at their own
// wake-ups (spinOnce() in a loop): what comes into it is kept until the program has a turn anyway,
// and handed over before any of its threads goes on. None can tell: queues, orders, sizes are as
// they would be, and so is the time of receipt. The first wait ends it.
//
// tf2_ros::TransformListener puts transforms into a buffer, in a thread of its own: who looks for
// them does so when it has something else to do. So they are handed over then, all at once, and no
// round is spent on each. Where the program asks the buffer to call it back, all come at once
// again.
#include "hearing.h"

#include <ros/param.h>
#include <ros/time.h>

#include <algorithm>
#include <atomic>
#include <boost/function.hpp>
#include <boost/signals2/connection.hpp>
#include <cstdint>
#include <mutex>
#include <set>
#include <string>
#include <typeinfo>
#include <utility>
#include <vector>

#include "node.h"
#include "roscpp_shim/machine/real.h"

namespace move_base_abstract::shim {
namespace {

using Lock = std::lock_guard<PlainMutex>;

const char* const kStatistics = "/enable_statistics";  // roscpp's; they tell when messages came

std::atomic<bool> calls_back{false};  // a buffer does, or roscpp counts
std::atomic<bool> hears_unread{false};

struct Listeners {
  PlainMutex mutex;
  std::vector<ros::CallbackQueue*> queues;
  // Queues on which a thread has waited, or which are not roscpp's own, for good.
  std::set<const ros::CallbackQueueInterface*> awaited;
};

Listeners& listeners() {
  static auto* const instance = new Listeners;
  return *instance;
}

std::vector<ros::CallbackQueue*> listenersQueues() {
  const Lock lock(listeners().mutex);
  return listeners().queues;
}

bool isListeners(const ros::CallbackQueueInterface* queue) {
  const auto queues = listenersQueues();
  return std::find(queues.begin(), queues.end(), queue) != queues.end();
}

/** @return whether nobody waits for what comes into it. The queue may be gone. */
bool isUnread(const ros::CallbackQueueInterface* queue) {
  const Lock lock(listeners().mutex);
  return listeners().awaited.count(queue) == 0;
}

/** @return whether it is new that somebody may wait for what comes into @p queue. */
bool addAwaited(const ros::CallbackQueueInterface* queue) {
  const Lock lock(listeners().mutex);
  return listeners().awaited.insert(queue).second;
}

/** @return whether roscpp tells how late messages are, at the moment at which they come. */
bool hasStatistics() {
  static const bool has_statistics = [] {
    bool value = false;
    return ros::param::get(kStatistics, value) && value;
  }();
  return has_statistics;
}

wire::Hearing hearingOf(const Topic& topic) {
  const auto all = [&topic](bool (*is_so)(const ros::CallbackQueueInterface*)) {
    return !topic.queues.empty() && std::all_of(topic.queues.begin(), topic.queues.end(), is_so);
  };
  if (hasStatistics()) {
    return wire::Hearing::kAll;
  }
  if (!calls_back && all(&isListeners)) {
    return wire::Hearing::kLater;
  }
  return all(&isUnread) ? wire::Hearing::kUnread : wire::Hearing::kAll;
}

void tell(Topic& topic) {
  const wire::Hearing hearing = hearingOf(topic);
  if (hearing != topic.hearing) {
    topic.hearing = hearing;
    hears_unread = hears_unread || hearing == wire::Hearing::kUnread;
    node().append(wire::Hears{topic.number, hearing});
  }
}

void tellAll() {
  for (auto& [number, topic] : topics().all()) {
    if (!topic.queues.empty()) {
      tell(topic);
    }
  }
}

}  // namespace

void noteSubscription(Topic& topic, const ros::SubscribeOptions& options) {
  const ros::CallbackQueueInterface* const queue = options.callback_queue;
  if (queue == nullptr || typeid(*queue) != typeid(ros::CallbackQueue)) {
    addAwaited(queue);  // of a class of the program's: it may act at once
  }
  topic.queues.push_back(queue);
  tell(topic);
}

void forgetSubscription(Topic& topic) {
  topic.queues.clear();
  topic.hearing = wire::Hearing::kAll;
}

void becomeListener(ros::CallbackQueue* queue) {
  if (isListeners(queue)) {
    return;
  }
  const Inside inside;
  {
    const Lock lock(listeners().mutex);
    listeners().queues.push_back(queue);
    listeners().awaited.insert(queue);
  }
  tellAll();
}

void noteWait(const void** last, const ros::CallbackQueue* queue) {
  if (std::exchange(*last, queue) == queue) {
    return;
  }
  const Inside inside;
  if (addAwaited(queue)) {
    tellAll();
  }
}

bool hearsUnread() { return hears_unread; }

void forgetListener(const void* queue) {
  const Lock lock(listeners().mutex);
  auto& queues = listeners().queues;
  queues.erase(std::remove(queues.begin(), queues.end(), queue), queues.end());
}

void beginCallingBack() {
  const bool is_app = turn().enter();
  const Inside inside;
  if (!calls_back.exchange(true) && is_app) {
    tellAll();
  }
}

void putTransformsBy() {
  using CallAvailable = void(ros::CallbackQueue*, ros::WallDuration);
  static CallAvailable* const function =
      real<CallAvailable>("_ZN3ros13CallbackQueue13callAvailableENS_12WallDurationE");
  if (calls_back) {
    return;
  }
  for (ros::CallbackQueue* const queue : listenersQueues()) {
    if (!queue->isEmpty()) {
      function(queue, ros::WallDuration());
    }
  }
}

}  // namespace move_base_abstract::shim

namespace shim = move_base_abstract::shim;

#pragma GCC visibility push(default)

namespace tf2 {

enum TransformableResult { TransformAvailable, TransformFailure };
using TransformableCallback = boost::function<void(
    std::uint64_t, const std::string&, const std::string&, ros::Time, TransformableResult)>;

/** @brief What is needed of tf2's, which programs without it are not to be built with. */
class BufferCore {
 public:
  std::uint32_t addTransformableCallback(const TransformableCallback& callback);
  boost::signals2::connection _addTransformsChangedListener(boost::function<void(void)> callback);
};

std::uint32_t BufferCore::addTransformableCallback(const TransformableCallback& callback) {
  using Add = std::uint32_t(BufferCore*, const TransformableCallback&);
  static Add* const function = shim::real<Add>(
      "_ZN3tf210BufferCore24addTransformableCallbackERKN5boost8functionIFvmRKNSt7__cxx1112basic_"
      "stringIcSt11char_traitsIcESaIcEEESA_N3ros4TimeENS_19TransformableResultEEEE");
  shim::beginCallingBack();
  return function(this, callback);
}

boost::signals2::connection BufferCore::_addTransformsChangedListener(
    boost::function<void(void)> callback) {
  using Add = boost::signals2::connection(BufferCore*, boost::function<void(void)>);
  static Add* const function =
      shim::real<Add>("_ZN3tf210BufferCore29_addTransformsChangedListenerEN5boost8functionIFvvEEE");
  shim::beginCallingBack();
  return function(this, callback);
}

}  // namespace tf2

#pragma GCC visibility pop
