// Topics and services of a participant as the time master knows them, and messages as bytes.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MEMBERSHIP_EXCHANGE_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MEMBERSHIP_EXCHANGE_H

#include <ros/advertise_options.h>
#include <ros/serialized_message.h>
#include <ros/service_callback_helper.h>
#include <ros/subscribe_options.h>

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "membership.h"

namespace move_base_abstract::lockstep::internal {

/** @brief A topic as the time master knows it. */
struct SharedTopic {
  std::uint32_t number = 0;
  std::string name;
  bool is_advertised = false;
  bool is_subscribed = false;
};

/**
 * @brief Topics by name and by number. References to them stay valid. @tparam Topic a SharedTopic.
 */
template <class Topic>
class TopicTable {
 public:
  Topic& of(const std::string& name) {
    const auto [at, is_new] =
        numbers_.emplace(name, static_cast<std::uint32_t>(numbers_.size() + 1));
    Topic& topic = topics_[at->second];
    if (is_new) {
      topic.number = at->second;
      topic.name = name;
    }
    return topic;
  }
  Topic* of(std::uint32_t number) {
    const auto found = topics_.find(number);
    return found == topics_.end() ? nullptr : &found->second;
  }
  /** @return the topics by their numbers. */
  std::map<std::uint32_t, Topic>& all() { return topics_; }

 private:
  std::map<std::string, std::uint32_t> numbers_;
  std::map<std::uint32_t, Topic> topics_;
};

// These tell the time master once, however many publishers and subscribers the node has. They do
// nothing for excluded topics.
void advertise(Membership& membership, SharedTopic& topic, const ros::AdvertiseOptions& options);
void unadvertise(Membership& membership, SharedTopic& topic);
void subscribe(Membership& membership, SharedTopic& topic, const ros::SubscribeOptions& options);
void unsubscribe(Membership& membership, SharedTopic& topic);

/** @return the header that roscpp would have for a connection to this publisher. */
ros::M_string headerOf(const wire::Publisher& item, const std::string& sender,
                       const std::string& topic);

/** @return the message without its length, as it is sent in frames. */
std::string_view payloadOf(const ros::SerializedMessage& message);
/** @return the message of a payload from a frame. */
ros::SerializedMessage messageOf(std::string_view payload);

/** @brief The result of a service's handler. */
struct Handled {
  bool is_good = false;
  std::string response;
  std::string error;  // text of the exception that it threw
};

/** @return the values of the event `uncaught`, after a handler of this service has thrown. */
std::string uncaughtOf(const std::string& service);

Handled handleCall(ros::ServiceCallbackHelper& helper, const std::string& service,
                   const std::string& caller, std::string_view request);

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MEMBERSHIP_EXCHANGE_H
