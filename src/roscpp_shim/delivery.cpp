// Which messages a program wants at once, and which can be kept for later.
//
// If no thread has ever waited on a queue, it is read by threads that go on at their own wake-ups
// (spinOnce() in a loop). Messages for it are kept until the program has a round anyway, and are
// delivered before any of its threads goes on. No thread can notice this: queues, orders, sizes and
// times of receipt are the same. The first wait on the queue ends it.
//
// If a library only stores the messages of a queue, they are delivered together in the same way,
// and no round is spent on each message.
#include "delivery.h"

#include <ros/param.h>
#include <ros/time.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <set>
#include <typeinfo>
#include <utility>
#include <vector>

#include "node.h"
#include "roscpp_shim/machine/real.h"

namespace move_base_abstract::shim {
namespace {

using Lock = std::lock_guard<PlainMutex>;

const char* const kStatistics = "/enable_statistics";  // roscpp's: it says when messages came

std::atomic<bool> calls_back{false};  // storing calls a function of the program
std::atomic<bool> keeps_unread{false};
__thread const ros::CallbackQueue* t_awaited = nullptr;  // the queue of the thread's latest wait

struct Queues {
  PlainMutex mutex;
  std::vector<ros::CallbackQueue*> stored;
  // Queues on which a thread has ever waited, or whose class is not roscpp's.
  std::set<const ros::CallbackQueueInterface*> awaited;
};

Queues& queues() {
  static auto* const instance = new Queues;
  return *instance;
}

std::vector<ros::CallbackQueue*> storedQueues() {
  const Lock lock(queues().mutex);
  return queues().stored;
}

bool isStored(const ros::CallbackQueueInterface* queue) {
  const auto stored = storedQueues();
  return std::find(stored.begin(), stored.end(), queue) != stored.end();
}

/** @return whether no thread has ever waited on the queue, which may be gone. */
bool isUnread(const ros::CallbackQueueInterface* queue) {
  const Lock lock(queues().mutex);
  return queues().awaited.count(queue) == 0;
}

/** @brief Note that a thread may wait on @p queue. @return whether this is new. */
bool addAwaited(const ros::CallbackQueueInterface* queue) {
  const Lock lock(queues().mutex);
  return queues().awaited.insert(queue).second;
}

/** @return whether roscpp publishes statistics of messages, which depend on when they come. */
bool hasStatistics() {
  static const bool has_statistics = [] {
    bool value = false;
    return ros::param::get(kStatistics, value) && value;
  }();
  return has_statistics;
}

wire::Delivery deliveryOf(const Topic& topic) {
  const auto all = [&topic](bool (*is_so)(const ros::CallbackQueueInterface*)) {
    return !topic.queues.empty() && std::all_of(topic.queues.begin(), topic.queues.end(), is_so);
  };
  if (hasStatistics()) {
    return wire::Delivery::kAll;
  }
  if (!calls_back && all(&isStored)) {
    return wire::Delivery::kLater;
  }
  return all(&isUnread) ? wire::Delivery::kUnread : wire::Delivery::kAll;
}

void tell(Topic& topic) {
  const wire::Delivery delivery = deliveryOf(topic);
  if (delivery != topic.delivery) {
    topic.delivery = delivery;
    keeps_unread = keeps_unread || delivery == wire::Delivery::kUnread;
    node().append(wire::ChooseDelivery{topic.number, delivery});
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
    addAwaited(queue);  // a class of the program's, which may act at once
  }
  topic.queues.push_back(queue);
  SharedChannel* const channel = node().membership().channel();
  if (channel != nullptr && topic.number < channel->directions().queue_of_topic.size()) {
    channel->directions().queue_of_topic[topic.number] = Turn::numberOf(queue);
  }
  tell(topic);
}

void forgetSubscription(Topic& topic) {
  topic.queues.clear();
  topic.delivery = wire::Delivery::kAll;
}

void noteWait(const ros::CallbackQueue* queue) {
  if (std::exchange(t_awaited, queue) == queue) {
    return;
  }
  const Inside inside;
  if (addAwaited(queue)) {
    tellAll();
  }
}

bool keepsUnread() { return keeps_unread; }

// ---- messages that are only stored -----------------------------------------------------------

void storeFrom(ros::CallbackQueue* queue) {
  if (isStored(queue)) {
    return;
  }
  const Inside inside;
  {
    const Lock lock(queues().mutex);
    queues().stored.push_back(queue);
    queues().awaited.insert(queue);
  }
  Turn::atEnd([queue] {
    const Lock lock(queues().mutex);
    auto& stored = queues().stored;
    stored.erase(std::remove(stored.begin(), stored.end(), queue), stored.end());
  });
  tellAll();
}

void storeNoMore() {
  const bool is_app = turn().enter();
  const Inside inside;
  if (!calls_back.exchange(true) && is_app) {
    tellAll();
  }
}

void store() {
  static auto* const function =
      real<void(ros::CallbackQueue*, ros::WallDuration)>("ros::CallbackQueue::callAvailable");
  if (calls_back) {
    return;
  }
  for (ros::CallbackQueue* const queue : storedQueues()) {
    if (!queue->isEmpty()) {
      function(queue, ros::WallDuration());
    }
  }
}

}  // namespace move_base_abstract::shim
