// Topics between participants; these replace roscpp's connections. roscpp's own publications and
// subscriptions stay in use: each has one more link for every participant at the other end.
#include "topics.h"

#include <ros/connection_manager.h>
#include <ros/names.h>
#include <ros/publication.h>
#include <ros/publisher_link.h>
#include <ros/subscriber_link.h>
#include <ros/subscription.h>
#include <ros/topic_manager.h>

#include <algorithm>
#include <cstring>

#include "exchange.h"
#include "node.h"
#include "roscpp_shim/machine/real.h"

namespace move_base_abstract::shim {
namespace {

/** @brief Gives access to a private member of a class: an explicit instantiation may name it. */
template <typename Tag, auto member>
struct Open {
  friend auto open(Tag) { return member; }
};

#define MOVE_BASE_ABSTRACT_OPEN(tag, member) \
  struct tag {                               \
    friend auto open(tag);                   \
  };                                         \
  template struct Open<tag, &member>

MOVE_BASE_ABSTRACT_OPEN(OfSubscriptions, ros::TopicManager::subscriptions_);
MOVE_BASE_ABSTRACT_OPEN(OfSubscriptionsMutex, ros::TopicManager::subs_mutex_);
MOVE_BASE_ABSTRACT_OPEN(OfPublications, ros::TopicManager::advertised_topics_);
MOVE_BASE_ABSTRACT_OPEN(OfAddPublisherLink, ros::Subscription::addPublisherLink);
MOVE_BASE_ABSTRACT_OPEN(OfPublisherLinks, ros::Subscription::publisher_links_);
MOVE_BASE_ABSTRACT_OPEN(OfPublisherLinksMutex, ros::Subscription::publisher_links_mutex_);
MOVE_BASE_ABSTRACT_OPEN(OfSubscriberLinks, ros::Publication::subscriber_links_);
MOVE_BASE_ABSTRACT_OPEN(OfSubscriberLinksMutex, ros::Publication::subscriber_links_mutex_);

/** @return a copy of a list in @p object, made under its lock. */
template <class Object, class OfList, class OfMutex>
auto copyOf(Object& object, OfList of_list, OfMutex of_mutex) {
  const boost::mutex::scoped_lock lock(object.*open(of_mutex));
  return object.*open(of_list);
}

auto allSubscriptions() {
  return copyOf(*ros::TopicManager::instance(), OfSubscriptions(), OfSubscriptionsMutex());
}

}  // namespace

/** @brief A publication's link to a participant that subscribes; it writes into the report. */
class MemberSubscriber : public ros::SubscriberLink {
 public:
  MemberSubscriber(const Topic& topic, std::uint32_t member) : own_topic_(topic), member_(member) {
    topic_ = topic.name;
    destination_caller_id_ = node().membership().memberOf(member).name;
    connection_id_ = ros::ConnectionManager::instance()->getNewConnectionID();
    parent_ = ros::TopicManager::instance()->lookupPublication(topic.name);
  }

  void enqueueMessage(const ros::SerializedMessage& message, bool, bool) override {
    if (!message.buf) {
      return;
    }
    const bool to_all = topics().broadcast == &own_topic_;
    if (to_all && topics().is_sent) {
      return;
    }
    topics().is_sent = to_all;
    constexpr std::size_t kLength = 4;  // bytes before the message, with its length
    const auto* const bytes = reinterpret_cast<const char*>(message.buf.get());
    node().append(wire::Send{own_topic_.number,
                             0,
                             to_all ? 0 : member_,
                             {bytes + kLength, message.num_bytes - kLength}});
    stats_.bytes_sent_ += message.num_bytes;
    stats_.message_data_sent_ += message.num_bytes;
    ++stats_.messages_sent_;
  }

  void drop() override {}
  std::string getTransportType() override { return "LOCKSTEP"; }
  std::string getTransportInfo() override { return "lockstep, through the time master"; }

 private:
  const Topic& own_topic_;
  std::uint32_t member_;
};

/** @brief A subscription's link to a participant that publishes. */
class MemberPublisher : public ros::PublisherLink {
 public:
  MemberPublisher(const ros::SubscriptionPtr& subscription, std::uint32_t member)
      : PublisherLink(subscription, node().membership().memberOf(member).uri,
                      ros::TransportHints()) {}

  boost::shared_ptr<ros::M_string> values() { return header_.getValues(); }
  void count(std::size_t bytes) {
    stats_.bytes_received_ += bytes;
    ++stats_.messages_received_;
  }

  void handleMessage(const ros::SerializedMessage&, bool, bool) override {}
  void drop() override {
    if (const auto parent = parent_.lock()) {
      parent->removePublisherLink(shared_from_this());
    }
  }
  std::string getTransportType() override { return "LOCKSTEP"; }
  std::string getTransportInfo() override { return "lockstep, through the time master"; }
};

ros::SubscriptionPtr subscriptionTo(const std::string& topic) {
  for (const auto& subscription : allSubscriptions()) {
    if (subscription->getName() == topic && !subscription->isDropped()) {
      return subscription;
    }
  }
  return nullptr;
}

ros::SubscriptionPtr subscriptionTo(Topic& topic) {
  ros::SubscriptionPtr found = topic.subscription.lock();
  if (!found || found->isDropped()) {
    found = subscriptionTo(topic.name);
    topic.subscription = found;
  }
  return found;
}

HandleMessage* handleMessage() {
  static auto* const function =
      real(&ros::Subscription::handleMessage, "ros::Subscription::handleMessage");
  return function;
}

Topics& topics() {
  static Topics* const instance = new Topics;
  return *instance;
}

bool isMemberLink(const ros::SubscriberLinkPtr& link) {
  return dynamic_cast<MemberSubscriber*>(link.get()) != nullptr;
}

// ---- connections -----------------------------------------------------------------------------

void dropConnectionsTo(const std::string& node_name) {
  for (const auto& subscription : allSubscriptions()) {
    for (const auto& link : copyOf(*subscription, OfPublisherLinks(), OfPublisherLinksMutex())) {
      if (isManaged(subscription->getName()) && link->getCallerID() == node_name) {
        link->drop();
      }
    }
  }
  for (const auto& publication :
       ros::V_Publication((*ros::TopicManager::instance()).*open(OfPublications()))) {
    for (const auto& link : copyOf(*publication, OfSubscriberLinks(), OfSubscriberLinksMutex())) {
      if (isManaged(publication->getName()) && link->getDestinationCallerID() == node_name) {
        publication->removeSubscriberLink(link);
        const std::lock_guard<PlainMutex> lock(topics().silent_mutex);
        topics().silent.push_back(link);
      }
    }
  }
}

// ---- mail of the time master -----------------------------------------------------------------

ros::SerializedMessage messageOf(std::string_view payload) {
  const boost::shared_array<std::uint8_t> bytes(new std::uint8_t[payload.size() + 1]);
  std::memcpy(bytes.get(), payload.data(), payload.size());
  return {bytes, payload.size()};
}

void handle(const wire::Subscriber& item) {
  Topic* const topic = topics().of(item.topic);
  const auto publication =
      topic == nullptr ? nullptr : ros::TopicManager::instance()->lookupPublication(topic->name);
  if (!publication) {
    return;
  }
  auto& link = topic->receivers[item.receiver];
  if (link) {  // it has unsubscribed and subscribed within a turn, and gets what is latched again
    publication->removeSubscriberLink(link);
  }
  link = boost::make_shared<MemberSubscriber>(*topic, item.receiver);
  publication->addSubscriberLink(link);
}

void handle(const wire::NoSubscriber& item) {
  Topic* const topic = topics().of(item.topic);
  const auto publication =
      topic == nullptr ? nullptr : ros::TopicManager::instance()->lookupPublication(topic->name);
  if (publication && topic->receivers.count(item.receiver) > 0) {
    publication->removeSubscriberLink(topic->receivers.at(item.receiver));
    topic->receivers.erase(item.receiver);
  }
}

void handle(const wire::Publisher& item) {
  Topic* const topic = topics().of(item.topic);
  const auto subscription = topic == nullptr ? nullptr : subscriptionTo(*topic);
  if (!subscription || topic->senders.count(item.sender) > 0) {
    return;
  }
  const ros::M_string values = {{"callerid", node().membership().memberOf(item.sender).name},
                                {"topic", topic->name},
                                {"type", std::string(item.type)},
                                {"md5sum", std::string(item.md5)},
                                {"message_definition", std::string(item.definition)},
                                {"latching", item.latched ? "1" : "0"}};
  boost::shared_array<std::uint8_t> bytes;
  std::uint32_t size = 0;
  ros::Header::write(values, bytes, size);
  ros::Header header;
  std::string error;
  header.parse(bytes.get(), size, error);
  const auto link = boost::make_shared<MemberPublisher>(subscription, item.sender);
  link->setHeader(header);
  topic->senders[item.sender] = link;
  ((*subscription).*open(OfAddPublisherLink()))(link);
}

void handle(const wire::NoPublisher& item) {
  Topic* const topic = topics().of(item.topic);
  const auto subscription = topic == nullptr ? nullptr : subscriptionTo(*topic);
  if (topic != nullptr && topic->senders.count(item.sender) > 0) {
    if (subscription) {
      subscription->removePublisherLink(topic->senders.at(item.sender));
    }
    topic->senders.erase(item.sender);
  }
}

void handle(const wire::Deliver& item) {
  Topic* const topic = topics().of(item.topic);
  const auto subscription = topic == nullptr ? nullptr : subscriptionTo(*topic);
  const auto sender =
      topic == nullptr ? decltype(topic->senders.find(0))() : topic->senders.find(item.sender);
  if (!subscription || sender == topic->senders.end()) {
    return;  // the program unsubscribed while it was under way
  }
  const auto& link = sender->second;
  link->count(item.payload.size());
  const Nanoseconds came = node().membership().came();
  const bool was_kept = came != node().now();
  if (was_kept) {
    node().setTime(came);  // roscpp takes it as the time of receipt
  }
  handleMessage()(subscription.get(), messageOf(item.payload), true, false, link->values(), link);
  if (was_kept) {
    node().setTime(node().now());
  }
}

}  // namespace move_base_abstract::shim
