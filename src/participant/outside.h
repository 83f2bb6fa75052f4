// Input that reaches a participant through roscpp itself. The participant's thread takes it.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_OUTSIDE_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_OUTSIDE_H

#include <ros/callback_queue_interface.h>
#include <ros/subscription_callback_helper.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

#include "copies.h"
#include "link.h"

namespace move_base_abstract::lockstep::internal {

/**
 * @brief Holds the callbacks from roscpp's threads until the participant takes them, and rings the
 * bell.
 */
class OutsideQueue : public ros::CallbackQueueInterface {
 public:
  explicit OutsideQueue(std::shared_ptr<Bell> bell) : bell_(std::move(bell)) {}

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) override {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      waiting_.emplace_back(owner, callback);
    }
    bell_->ring();
  }

  void removeByID(std::uint64_t owner) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_.erase(std::remove_if(waiting_.begin(), waiting_.end(),
                                  [owner](const auto& entry) { return entry.first == owner; }),
                   waiting_.end());
  }

  bool empty() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return waiting_.empty();
  }

  /** @return the first callback, and remove it from the queue; null if there is none. */
  ros::CallbackInterfacePtr take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (waiting_.empty()) {
      return nullptr;
    }
    auto callback = waiting_.front().second;
    waiting_.pop_front();
    return callback;
  }

 private:
  std::shared_ptr<Bell> bell_;
  mutable std::mutex mutex_;
  std::deque<std::pair<std::uint64_t, ros::CallbackInterfacePtr>> waiting_;
};

/**
 * @brief The latest message that was read on a topic. roscpp reads a message once for all
 * subscriptions of its type.
 */
using Reading = std::shared_ptr<std::size_t>;  // Copies::digestOf()

/**
 * @brief Wraps a subscription's own helper. It hands each message to a handler instead of calling
 * the callback.
 */
class Interceptor : public ros::SubscriptionCallbackHelper {
 public:
  using Handler = std::function<void(const ros::MessageEvent<void const>&)>;

  Interceptor(ros::SubscriptionCallbackHelperPtr inner, Reading reading, Handler handler)
      : inner_(std::move(inner)), reading_(std::move(reading)), handler_(std::move(handler)) {}

  ros::VoidConstPtr deserialize(
      const ros::SubscriptionCallbackHelperDeserializeParams& params) override {
    *reading_ = Copies::digestOf({reinterpret_cast<const char*>(params.buffer), params.length},
                                 inner_->hasHeader());
    return inner_->deserialize(params);
  }
  void call(ros::SubscriptionCallbackHelperCallParams& params) override { handler_(params.event); }
  const std::type_info& getTypeInfo() override { return inner_->getTypeInfo(); }
  bool isConst() override { return inner_->isConst(); }
  bool hasHeader() override { return inner_->hasHeader(); }

 private:
  ros::SubscriptionCallbackHelperPtr inner_;
  Reading reading_;
  Handler handler_;
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_OUTSIDE_H
