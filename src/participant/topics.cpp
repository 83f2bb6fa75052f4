// Topics of a participant. Messages between members go by report and grant, all others by roscpp.
#include <ros/console.h>
#include <ros/single_subscriber_publisher.h>
#include <ros/topic_manager.h>

#include <algorithm>

#include "core.h"

namespace move_base_abstract::lockstep::internal {
namespace {

/**
 * @brief Write the sequence number, as roscpp does: it is the first field of the header, which is
 * the first field of the message.
 */
void writeSequence(const ros::SerializedMessage& message, std::uint32_t sequence) {
  ros::serialization::OStream stream(message.message_start, sizeof(sequence));
  ros::serialization::serialize(stream, sequence);
}

}  // namespace

void Core::makeConstant(const std::string& topic) {
  std::string rest;
  topicOf(nodeFor(topic, &rest).resolveName(rest)).constant = true;
}

ros::NodeHandle& Core::nodeFor(const std::string& name, std::string* rest) {
  const bool is_private = !name.empty() && name[0] == '~';
  *rest = is_private ? name.substr(1) : name;
  return is_private ? private_node_ : node_;
}

Topic& Core::topicOf(const std::string& name) {
  Topic& topic = topics_.of(name);
  topic.excluded = membership_.isExcluded(name);
  return topic;
}

// ---- publishing ------------------------------------------------------------------------------

std::shared_ptr<Publication> Core::advertise(const ros::AdvertiseOptions& options) {
  check("advertise");
  std::string rest;
  ros::NodeHandle& node = nodeFor(options.topic, &rest);
  Topic& topic = topicOf(node.resolveName(rest));
  if (topic.publications > 0 && topic.md5 != options.md5sum) {
    throw Error("lockstep: " + name() + " publishes " + topic.name +
                " with another type already, got " + options.datatype);
  }
  if (topic.publications == 0) {
    topic.md5 = options.md5sum;
    topic.latched = options.latch;
    topic.has_header = options.has_header;
    internal::advertise(membership_, topic, options);
    ros::AdvertiseOptions outside = options;
    outside.topic = rest;
    outside.callback_queue = own_queue_.get();
    const std::uint32_t number = topic.number;
    outside.connect_cb = [this, number](const ros::SingleSubscriberPublisher& peer) {
      connectionChanged(number, peer.getSubscriberName(), true);
    };
    outside.disconnect_cb = [this, number](const ros::SingleSubscriberPublisher& peer) {
      connectionChanged(number, peer.getSubscriberName(), false);
    };
    topic.outside = node.advertise(outside);
  }
  ++topic.publications;
  return std::make_shared<Publication>(shared_from_this(), topic);
}

Publication::~Publication() {
  if (const auto core = core_.lock()) {
    core->unadvertise(*topic_);
  }
}

void Core::unadvertise(Topic& topic) {
  if (--topic.publications > 0) {
    return;
  }
  internal::unadvertise(membership_, topic);
  topic.outside.shutdown();
  topic.connected.clear();
  topic.receivers.clear();
  topic.last.reset();
}

void Core::publish(Topic& topic, const ros::SerializedMessage& message, const std::string& md5) {
  check("publish");
  if (md5 != topic.md5 && topic.md5 != "*") {
    throw Error("lockstep: " + name() + " publishes on " + topic.name +
                " a message of another type than it advertised");
  }
  if (topic.has_header) {
    writeSequence(message, topic.sequence++);
  }
  const std::string_view payload = payloadOf(message);
  if (topic.excluded) {
    // nothing to tell the time master
  } else if (!topic.latched) {
    append(wire::Send{topic.number, 0, 0, payload});
  } else {
    // Only to the known receivers. Another one gets it once, when its SUBSCRIBER item comes.
    topic.last = std::string(payload);
    for (const std::uint32_t receiver : topic.receivers) {
      append(wire::Send{topic.number, 0, receiver, payload});
    }
  }
  takeOutside();
  if (topic.latched || hasOutsiders(topic)) {
    ros::SerializedMessage copy;
    ros::TopicManager::instance()->publish(
        topic.name, [&message] { return message; }, copy);
  }
}

void Core::connectionChanged(std::uint32_t number, const std::string& node, bool connected) {
  Topic* const topic = topics_.of(number);
  if (connected) {
    topic->connected.insert(node);
  } else if (const auto found = topic->connected.find(node); found != topic->connected.end()) {
    topic->connected.erase(found);
  }
}

bool Core::hasOutsiders(const Topic& topic) {
  return std::any_of(topic.connected.begin(), topic.connected.end(), [&](const std::string& node) {
    return topic.excluded || !membership_.isMember(node);
  });
}

std::uint32_t Core::subscribers(Topic& topic) {
  if (topic.excluded) {
    takeOutside();
    return static_cast<std::uint32_t>(topic.connected.size());
  }
  return static_cast<std::uint32_t>(topic.receivers.size());  // an onlooker does not count
}

void Core::handle(const wire::Subscriber& item) {
  Topic* const topic = topics_.of(item.topic);
  if (topic != nullptr && topic->publications > 0) {
    const bool is_new = topic->receivers.insert(item.receiver).second;
    if (is_new && topic->last) {
      append(wire::Send{topic->number, 0, item.receiver, *topic->last});
    }
  }
}

void Core::handle(const wire::NoSubscriber& item) {
  if (Topic* const topic = topics_.of(item.topic)) {
    topic->receivers.erase(item.receiver);
  }
}

// ---- listening -------------------------------------------------------------------------------

Subscription::Subscription(const std::shared_ptr<Core>& core, Topic& topic,
                           const ros::SubscribeOptions& options)
    : core_(core), topic_(&topic), options_(options) {}

Subscription::~Subscription() {
  if (const auto core = core_.lock()) {
    core->unsubscribe(*this);
  }
}

void Subscription::listenOutside(ros::NodeHandle& node, const std::shared_ptr<OutsideQueue>& queue,
                                 const std::string& unresolved, Interceptor::Handler handler) {
  queue_ = queue;
  ros::SubscribeOptions outside = options_;
  outside.topic = unresolved;
  outside.queue_size = 0;  // ours applies at delivery; copies from members must not displace others
  outside.callback_queue = queue.get();
  outside.helper =
      boost::make_shared<Interceptor>(options_.helper, topic_->reading, std::move(handler));
  outside_ = node.subscribe(outside);
}

bool Subscription::isWanted() {
  const std::size_t before = waiting_--;
  return options_.queue_size == 0 || before <= options_.queue_size;
}

void Subscription::handle(const HeaderPtr& header, const std::string& payload) {
  ros::SubscriptionCallbackHelperDeserializeParams params;
  // The helper only reads, although its interface has no const.
  params.buffer = reinterpret_cast<std::uint8_t*>(const_cast<char*>(payload.data()));
  params.length = static_cast<std::uint32_t>(payload.size());
  params.connection_header = header;
  ros::VoidConstPtr message;
  try {
    message = options_.helper->deserialize(params);
  } catch (const std::exception& error) {
    ROS_ERROR("lockstep: a message on %s from %s cannot be read: %s", topic_->name.c_str(),
              (*header)["callerid"].c_str(), error.what());
    return;
  }
  if (message) {
    handle(ros::MessageEvent<void const>(message, header, ros::Time::now(), false,
                                         ros::MessageEvent<void const>::CreateFunction()));
  }
}

void Subscription::handle(const ros::MessageEvent<void const>& event) {
  ros::SubscriptionCallbackHelperCallParams params;
  params.event = event;
  options_.helper->call(params);
}

std::shared_ptr<Subscription> Core::subscribe(const ros::SubscribeOptions& options) {
  check("subscribe");
  std::string rest;
  ros::NodeHandle& node = nodeFor(options.topic, &rest);
  Topic& topic = topicOf(node.resolveName(rest));
  for (const Subscription* other : topic.subscriptions) {
    if (!other->takes(options.md5sum) && options.md5sum != "*") {
      throw Error("lockstep: " + name() + " listens to " + topic.name +
                  " with another type already, got " + options.datatype);
    }
  }
  const auto subscription = std::make_shared<Subscription>(shared_from_this(), topic, options);
  internal::subscribe(membership_, topic, options);
  topic.subscriptions.push_back(subscription.get());
  for (const auto& [id, sender] : topic.publishers) {
    if (sender.last) {  // it has come already, for an older subscription
      deliver(subscription, sender.header, *sender.last);
    }
  }
  const std::weak_ptr<Subscription> weak = subscription;
  subscription->listenOutside(
      node, own_queue_, rest,
      [this, weak](const ros::MessageEvent<void const>& event) { fromOutside(weak, event); });
  return subscription;
}

void Core::unsubscribe(Subscription& subscription) {
  Topic& topic = subscription.topic();
  auto& all = topic.subscriptions;
  all.erase(std::remove(all.begin(), all.end(), &subscription), all.end());
  if (all.empty()) {
    internal::unsubscribe(membership_, topic);
    topic.publishers.clear();
  }
}

void Core::handle(const wire::Publisher& item) {
  Topic* const topic = topics_.of(item.topic);
  if (topic == nullptr || topic->subscriptions.empty()) {
    return;
  }
  Sender& sender = topic->publishers[item.sender];
  sender.md5 = item.md5;
  sender.latched = item.latched;
  sender.header = boost::make_shared<ros::M_string>(
      headerOf(item, membership_.nameOf(item.sender), topic->name));
  ros::M_string& header = *sender.header;
  for (const Subscription* subscription : topic->subscriptions) {
    if (!subscription->takes(sender.md5)) {
      ROS_ERROR(
          "lockstep: %s publishes %s as %s with md5 %s; %s listens with md5 %s and gets nothing",
          header["callerid"].c_str(), topic->name.c_str(), header["type"].c_str(),
          sender.md5.c_str(), name().c_str(), subscription->md5().c_str());
    }
  }
}

void Core::handle(const wire::NoPublisher& item) {
  if (Topic* const topic = topics_.of(item.topic)) {
    topic->publishers.erase(item.sender);
  }
}

void Core::handle(const wire::Deliver& item) {
  Topic* const topic = topics_.of(item.topic);
  const auto found =
      topic == nullptr ? decltype(topic->publishers.end()){} : topic->publishers.find(item.sender);
  if (topic == nullptr || found == topic->publishers.end()) {
    return;  // unsubscribed while it was under way
  }
  Sender& sender = found->second;
  const std::string payload(item.payload);
  topic->copies.delivered((*sender.header)["callerid"],
                          Copies::digestOf(payload, topic->subscriptions.front()->hasHeader()));
  for (Subscription* subscription : topic->subscriptions) {
    if (subscription->takes(sender.md5)) {
      deliver(subscription->shared_from_this(), sender.header, payload);
    }
  }
  if (sender.latched) {
    sender.last = payload;
  }
}

void Core::deliver(const std::shared_ptr<Subscription>& subscription, const HeaderPtr& header,
                   const std::string& payload) {
  subscription->expect();
  mail_.emplace_back([weak = std::weak_ptr<Subscription>(subscription), header, payload] {
    const auto alive = weak.lock();
    if (alive && alive->isWanted()) {
      alive->handle(header, payload);
    }
  });
}

// ---- from outside ----------------------------------------------------------------------------

void Core::takeOutside() {
  while (const auto callback = own_queue_->take()) {
    callback->call();
  }
}

void Core::fromOutside(const std::weak_ptr<Subscription>& weak,
                       const ros::MessageEvent<void const>& event) {
  const auto subscription = weak.lock();
  const std::string& sender = event.getPublisherName();
  if (!subscription) {
    return;
  }
  Topic& topic = subscription->topic();
  if (!topic.excluded && isCopy(topic, sender, event.getConnectionHeaderPtr())) {
    return;  // a member's message comes with a grant; this is the copy for other nodes
  }
  if (!topic.constant && !topic.excluded) {
    label("a message on " + topic.name + " came from " + sender + ", which does not take part");
  }
  subscription->expect();
  outside_.emplace_back([weak, event] {
    const auto alive = weak.lock();
    if (alive && alive->isWanted()) {
      alive->handle(event);
    }
  });
}

bool Core::isCopy(Topic& topic, const std::string& sender, const Copies::Connection& connection) {
  if (membership_.isMember(sender)) {
    topic.copies.came(connection);
    return true;
  }
  return topic.copies.isCopy(sender, connection, *topic.reading);
}

void Core::enterOutside() {
  for (auto& input : outside_) {
    mail_.push_back(std::move(input));
  }
  outside_.clear();
  while (const auto callback = user_queue_->take()) {
    label("a call, a message or a timer has reached " + name() + " from outside of lockstep");
    mail_.emplace_back([callback] { callback->call(); });
  }
}

}  // namespace move_base_abstract::lockstep::internal
