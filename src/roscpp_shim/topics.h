// The program's topics as the time master knows them.
#pragma once

#include <ros/publisher_link.h>
#include <ros/subscriber_link.h>
#include <ros/subscription.h>

#include <map>
#include <string>
#include <vector>

#include "turn.h"

namespace move_base_abstract::shim {

class MemberSubscriber;
class MemberPublisher;

struct Topic {
  std::uint32_t number = 0;
  std::string name;
  bool is_advertised = false;  // the time master knows that the program publishes it
  bool is_subscribed = false;
  boost::weak_ptr<ros::Subscription> subscription;                         // the last one found
  std::map<std::uint32_t, boost::shared_ptr<MemberSubscriber>> receivers;  // by participant
  std::map<std::uint32_t, boost::shared_ptr<MemberPublisher>> senders;     // by participant
  std::vector<const ros::CallbackQueueInterface*> queues;  // the queues for its messages
  wire::Delivery delivery = wire::Delivery::kAll;          // as the time master knows it
};

using HandleMessage = std::uint32_t(ros::Subscription*, const ros::SerializedMessage&, bool, bool,
                                    const boost::shared_ptr<ros::M_string>&,
                                    const ros::PublisherLinkPtr&);

/** @return roscpp's own Subscription::handleMessage. */
HandleMessage* handleMessage();

/** @brief The program's topics. Only the thread with the turn uses them. */
class Topics {
 public:
  /** @return the topic; the reference stays valid. */
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

  /** The topic of a message that is being published to all, and whether the report has it already.
   */
  const Topic* broadcast = nullptr;
  bool is_sent = false;
  /** roscpp's links to participants. They are kept, so that roscpp does not make them again, but
   * carry nothing. */
  std::vector<ros::SubscriberLinkPtr> silent;
  PlainMutex silent_mutex;

 private:
  std::map<std::string, std::uint32_t> numbers_;
  std::map<std::uint32_t, Topic> topics_;
};

Topics& topics();
/** @return the program's subscription to @p topic, if there is one. */
ros::SubscriptionPtr subscriptionTo(const std::string& topic);
ros::SubscriptionPtr subscriptionTo(Topic& topic);
/** @return whether @p link leads to a participant through the time master. */
bool isMemberLink(const ros::SubscriberLinkPtr& link);

}  // namespace move_base_abstract::shim
