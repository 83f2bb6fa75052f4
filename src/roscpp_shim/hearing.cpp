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
#include <string>
#include <utility>
#include <vector>

#include "node.h"
#include "real.h"

namespace move_base_abstract::shim {
namespace {

using Lock = std::lock_guard<PlainMutex>;

const char* const kStatistics = "/enable_statistics";  // roscpp's; they tell when messages came

std::atomic<bool> calls_back{false};  // a buffer does, or roscpp counts

struct Listeners {
  PlainMutex mutex;
  std::vector<ros::CallbackQueue*> queues;
  bool has_begun = false;
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

void tell(Topic& topic) {
  const bool is_later = !calls_back && !topic.queues.empty() &&
                        std::all_of(topic.queues.begin(), topic.queues.end(), &isListeners);
  if (is_later != topic.is_heard_later) {
    topic.is_heard_later = is_later;
    node().append(
        wire::Hears{topic.number, is_later ? wire::Hearing::kLater : wire::Hearing::kAll});
  }
}

void tellAll() {
  for (auto& [number, topic] : topics().all()) {
    if (!topic.queues.empty()) {
      tell(topic);
    }
  }
}

/** @return whether it is the first one. */
bool addListener(ros::CallbackQueue* queue) {
  const Lock lock(listeners().mutex);
  listeners().queues.push_back(queue);
  return !std::exchange(listeners().has_begun, true);
}

}  // namespace

void noteSubscription(Topic& topic, const ros::SubscribeOptions& options) {
  topic.queues.push_back(options.callback_queue);
  tell(topic);
}

void forgetSubscription(Topic& topic) {
  topic.queues.clear();
  topic.is_heard_later = false;
}

void becomeListener(ros::CallbackQueue* queue) {
  if (isListeners(queue)) {
    return;
  }
  const Inside inside;
  bool has_statistics = false;
  if (addListener(queue) && ros::param::get(kStatistics, has_statistics) && has_statistics) {
    calls_back = true;
  }
  tellAll();
}

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
