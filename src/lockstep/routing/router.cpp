#include "router.h"

#include <algorithm>
#include <utility>

#include "router_parts.h"

namespace move_base_abstract {
namespace {

bool fit(std::string_view advertised, std::string_view subscribed) {
  return subscribed == "*" || advertised == "*" || advertised == subscribed;
}

/** @return what publishers are to know of @p what: not when a message is handed over. */
wire::Delivery toPublishers(wire::Delivery what) {
  return what > wire::Delivery::kAll ? wire::Delivery::kAll : what;
}

}  // namespace

const char* MessageRouter::Delivery::kindName() const {
  return !lost.empty()            ? "lost"
         : kind == Kind::kMessage ? "message"
         : kind == Kind::kCall    ? "call"
                                  : "response";
}

std::string MessageRouter::Delivery::from(const NameOf& name_of) const {
  return sender_name.empty() && sender != 0 ? name_of(sender) : std::string(sender_name);
}

std::vector<std::string> MessageRouter::Delivery::to(const NameOf& name_of) const {
  std::vector<std::string> names;
  for (const MemberId id : receivers) {
    names.push_back(name_of(id));
  }
  std::sort(names.begin(), names.end(), naturalLess);
  return names;
}

MessageRouter::MessageRouter(Post post, Place place, Trace trace)
    : post_(std::move(post)), place_(std::move(place)), trace_(std::move(trace)) {}

void MessageRouter::add(MemberId id, const std::string& name) { participants_[id].name = name; }

void MessageRouter::apply(MemberId sender, std::uint64_t number, const wire::ReportItem& item) {
  const Action by{sender, number};
  std::visit([&](const auto& action) { act(by, action); }, item);
}

std::vector<std::string> MessageRouter::takeWarnings() {
  std::vector<std::string> warnings;
  warnings.swap(warnings_);
  return warnings;
}

void MessageRouter::bad(MemberId id, const std::string& text) const {
  throw BadAction("'" + participants_.at(id).name + "': " + text);
}

std::string_view MessageRouter::keep(std::string_view text) {
  const auto found = texts_.find(text);
  return found != texts_.end() ? *found : *texts_.emplace(text).first;
}

// ---- topics ----------------------------------------------------------------------------------

MessageRouter::LocalTopic& MessageRouter::declare(MemberId id, std::uint32_t number,
                                                  std::string_view name) {
  if (name.empty()) {
    bad(id, "topic " + std::to_string(number) + " must have a name, got an empty one");
  }
  const std::string_view kept = keep(name);
  const auto index = static_cast<Index>(topics_.size());
  const auto [known, fresh] = topic_numbers_.try_emplace(kept, index);
  if (fresh) {
    topics_.push_back({kept, {}, {}, OpenGoals::Part::kNone});
  }
  auto [local, first] =
      participant(id).topics.try_emplace(number, LocalTopic{known->second, false, {}});
  if (!first && local->second.topic != known->second) {
    bad(id, "number " + std::to_string(number) + " is that of topic '" +
                std::string(topics_[local->second.topic].name) + "', got it for '" +
                std::string(name) + "'");
  }
  return local->second;
}

MessageRouter::LocalTopic& MessageRouter::declared(MemberId id, std::uint32_t number,
                                                   const char* what) {
  auto& topics = participant(id).topics;
  const auto local = topics.find(number);
  if (local == topics.end()) {
    bad(id, std::string(what) + " must name a topic that was declared, got number " +
                std::to_string(number));
  }
  return local->second;
}

void MessageRouter::checkNumber(MemberId id, const Topic& topic, std::uint32_t known,
                                std::uint32_t got) const {
  if (known != got) {
    bad(id, "topic '" + std::string(topic.name) + "' has its number " + std::to_string(known) +
                ", got a second one, " + std::to_string(got));
  }
}

void MessageRouter::act(const Action& by, const wire::Advertise& item) {
  LocalTopic& local = declare(by.sender, item.topic, item.name);
  Topic& topic = topics_[local.topic];
  const Advertised publisher{by.sender,      item.topic,   keep(item.type),
                             keep(item.md5), item.latched, definitionOf(item)};
  const auto present = router::findMember(topic.publishers, by.sender);
  if (present != topic.publishers.end()) {
    checkNumber(by.sender, topic, present->topic, item.topic);
    if (present->md5 == publisher.md5 && present->latched == publisher.latched) {
      return;  // one more publisher in the same node, which the node handles itself
    }
    stopAdvertising(by, local);
  }
  topic.publishers.push_back(publisher);
  topic.part = OpenGoals::partOf(topic.name, publisher.type);
  local.md5 = publisher.md5;
  local.advertised = true;
  for (const Subscribed& subscriber : topic.subscribers) {
    link(by, topic, publisher, subscriber);
  }
}

std::string_view MessageRouter::definitionOf(const wire::Advertise& item) {
  std::string_view& known = definitions_[keep(item.md5)];
  if (known.empty()) {
    known = keep(item.definition);
  }
  return item.definition.empty() ? known : keep(item.definition);
}

void MessageRouter::act(const Action& by, const wire::Unadvertise& item) {
  stopAdvertising(by, declared(by.sender, item.topic, "UNADVERTISE"));
}

void MessageRouter::stopAdvertising(const Action& by, LocalTopic& local) {
  Topic& topic = topics_[local.topic];
  const auto publisher = router::findMember(topic.publishers, by.sender);
  if (publisher == topic.publishers.end()) {
    return;
  }
  for (const Subscribed& subscriber : topic.subscribers) {
    if (fit(publisher->md5, subscriber.md5) &&
        !late_links_.forget(linkOf(topic, by.sender, subscriber.member))) {
      closings_.push_back({true, subscriber.member, subscriber.topic, local.topic, by.sender,
                           place_(by.sender, router::kLastSub, by.number)});
    }
  }
  topic.publishers.erase(publisher);
  local.advertised = false;
  dropMessages(topic, by.sender, 0);
}

void MessageRouter::act(const Action& by, const wire::Subscribe& item) {
  LocalTopic& local = declare(by.sender, item.topic, item.name);
  Topic& topic = topics_[local.topic];
  const Subscribed subscriber{by.sender, item.topic, keep(item.md5), item.sub,
                              stored_.has(participant(by.sender).name, topic.name)};
  const auto present = router::findMember(topic.subscribers, by.sender);
  if (present != topic.subscribers.end()) {
    checkNumber(by.sender, topic, present->topic, item.topic);
    if (present->md5 == subscriber.md5) {
      return;  // one more subscriber in the same node, which the node handles itself
    }
    stopSubscribing(by, local);
  }
  topic.subscribers.push_back(subscriber);
  for (const Advertised& publisher : topic.publishers) {
    link(by, topic, publisher, subscriber);
  }
}

void MessageRouter::act(const Action& by, const wire::Unsubscribe& item) {
  stopSubscribing(by, declared(by.sender, item.topic, "UNSUBSCRIBE"));
}

void MessageRouter::stopSubscribing(const Action& by, LocalTopic& local) {
  Topic& topic = topics_[local.topic];
  const auto subscriber = router::findMember(topic.subscribers, by.sender);
  if (subscriber == topic.subscribers.end()) {
    return;
  }
  for (const Advertised& publisher : topic.publishers) {
    if (fit(publisher.md5, subscriber->md5) &&
        !late_links_.forget(linkOf(topic, publisher.member, by.sender))) {
      closings_.push_back({false, publisher.member, publisher.topic, local.topic, by.sender,
                           place_(by.sender, router::kLastSub, by.number)});
    }
  }
  topic.subscribers.erase(subscriber);
  dropMessages(topic, 0, by.sender);
}

void MessageRouter::link(const Action& by, const Topic& topic, const Advertised& publisher,
                         const Subscribed& subscriber) {
  if (!fit(publisher.md5, subscriber.md5)) {
    warnings_.push_back("topic '" + std::string(topic.name) + "' is not connected from '" +
                        participant(publisher.member).name + "' (type " +
                        std::string(publisher.type) + ", md5 " + std::string(publisher.md5) +
                        ") to '" + participant(subscriber.member).name + "' (md5 " +
                        std::string(subscriber.md5) + "): their types differ");
    return;
  }
  if (!isLate(by, topic, linkOf(topic, publisher.member, subscriber.member))) {
    open(by, publisher, subscriber);
  }
}

/** @brief Tell both ends of a link that it is up. */
void MessageRouter::open(const Action& by, const Advertised& publisher,
                         const Subscribed& subscriber) {
  const MailOrder order = place_(by.sender, router::kFirstSub, by.number);
  post_(subscriber.member,
        {order, wire::Publisher{subscriber.topic, publisher.member, publisher.type, publisher.md5,
                                publisher.latched, publisher.definition}});
  if (greeted_.insert({publisher.member, publisher.topic, subscriber.member}).second) {
    post_(publisher.member, {order, wire::Subscriber{publisher.topic, subscriber.member}});
  }
  if (toPublishers(subscriber.delivery) != wire::Delivery::kAll) {
    tellHearing(by, publisher, subscriber);
  }
}

void MessageRouter::act(const Action& by, const wire::ChooseDelivery& item) {
  Topic& topic = topics_[declared(by.sender, item.topic, "CHOOSE_DELIVERY").topic];
  const auto subscriber = router::findMember(topic.subscribers, by.sender);
  if (subscriber == topic.subscribers.end()) {
    bad(by.sender, "CHOOSE_DELIVERY must name a topic that it subscribes to, got '" +
                       std::string(topic.name) + "'");
  }
  const bool is_news = toPublishers(subscriber->delivery) != toPublishers(item.what);
  subscriber->delivery = item.what;
  if (!is_news) {
    return;
  }
  for (const Advertised& publisher : topic.publishers) {
    if (fit(publisher.md5, subscriber->md5) &&
        !late_links_.has(linkOf(topic, publisher.member, by.sender))) {
      tellHearing(by, publisher, *subscriber);
    }
  }
}

void MessageRouter::tellHearing(const Action& by, const Advertised& publisher,
                                const Subscribed& subscriber) {
  post_(publisher.member, {place_(by.sender, router::kFirstSub, by.number),
                           wire::DeliveryChosen{publisher.topic, subscriber.member,
                                                toPublishers(subscriber.delivery)}});
}

bool MessageRouter::linked(const Topic& topic, MemberId publisher, MemberId subscriber) const {
  const auto from = router::findMember(topic.publishers, publisher);
  const auto to = router::findMember(topic.subscribers, subscriber);
  return from != topic.publishers.end() && to != topic.subscribers.end() &&
         fit(from->md5, to->md5) && !late_links_.has(linkOf(topic, publisher, subscriber));
}

void MessageRouter::finishRound() {
  for (const Closing& closing : closings_) {
    const Topic& topic = topics_[closing.topic];
    const MemberId publisher = closing.publisher ? closing.other : closing.receiver;
    const MemberId subscriber = closing.publisher ? closing.receiver : closing.other;
    if (linked(topic, publisher, subscriber)) {
      continue;
    }
    if (closing.publisher) {
      post_(closing.receiver, {closing.order, wire::NoPublisher{closing.number, closing.other}});
    } else {
      post_(closing.receiver, {closing.order, wire::NoSubscriber{closing.number, closing.other}});
    }
  }
  closings_.clear();
  greeted_.clear();
}

void MessageRouter::act(const Action& by, const wire::Send& item) {
  const LocalTopic& local = declared(by.sender, item.topic, "SEND");
  const Topic& topic = topics_[local.topic];
  if (!local.advertised) {
    bad(by.sender,
        "SEND must be on a topic that it advertises, got '" + std::string(topic.name) + "'");
  }
  const MailOrder order = place_(by.sender, item.sub, by.number);
  std::vector<MemberId> receivers;
  std::vector<MemberId> later;  // the receivers that get it later, or never
  bool is_received = false;
  for (const Subscribed& subscriber : topic.subscribers) {
    if ((item.target != 0 && item.target != subscriber.member) ||
        subscriber.delivery == wire::Delivery::kNothing || !fit(local.md5, subscriber.md5) ||
        late_links_.has(linkOf(topic, by.sender, subscriber.member))) {
      continue;
    }
    const wire::Deliver deliver{subscriber.topic, by.sender, item.payload};
    if (carriage_ != nullptr && !arrivesAtOnce(by, item, topic, deliver, subscriber.member)) {
      later.push_back(subscriber.member);
      is_received = is_received || !is_lost_;
      continue;
    }
    is_received = true;
    post_(subscriber.member,
          {order, deliver, router::keepFor(subscriber.delivery, subscriber.is_stored)});
    ++messages_;
    if (trace_) {
      receivers.push_back(subscriber.member);
    }
  }
  if (topic.part != OpenGoals::Part::kNone) {
    noteGoal(by.sender, topic, item.payload, is_received, later);
  }
  if (!receivers.empty()) {
    trace_({Delivery::Kind::kMessage, order, topic.name, by.sender, std::move(receivers),
            wire::CallStatus::kOk, item.payload, typeOf(topic, by.sender)});
  }
}

/**
 * @brief Note a goal or a result that was sent. @param later the receivers that get it later, or
 * never.
 */
void MessageRouter::noteGoal(MemberId sender, const Topic& topic, std::string_view payload,
                             bool is_received, const std::vector<MemberId>& later) {
  const auto is_client = [&](MemberId id) { return id == goals_.clientOf(topic.name, payload); };
  if (topic.part == OpenGoals::Part::kGoal && is_received && awaitsResults(sender, topic.name)) {
    goals_.sent(sender, topic.name, payload);
  } else if (topic.part == OpenGoals::Part::kResult &&
             std::none_of(later.begin(), later.end(), is_client)) {
    goals_.answered(topic.name, payload);
  }
}

std::string_view MessageRouter::typeOf(const Topic& topic, MemberId sender) {
  for (const Advertised& publisher : topic.publishers) {
    if (publisher.member == sender) {
      return publisher.type;
    }
  }
  return {};
}

std::string_view MessageRouter::md5Of(std::string_view topic, MemberId sender) const {
  const auto found = topic_numbers_.find(topic);
  if (found != topic_numbers_.end()) {
    for (const Advertised& publisher : topics_[found->second].publishers) {
      if (publisher.member == sender) {
        return publisher.md5;
      }
    }
  }
  return {};
}

/** @return whether a member that sends a goal subscribes to the results. */
bool MessageRouter::awaitsResults(MemberId client, std::string_view goal_topic) const {
  const auto result = topic_numbers_.find(OpenGoals::resultTopic(goal_topic));
  if (result == topic_numbers_.end()) {
    return false;
  }
  const auto& listeners = topics_[result->second].subscribers;
  return router::findMember(listeners, client) != listeners.end();
}

std::string_view MessageRouter::topicName(MemberId id, std::uint32_t number) const {
  const auto member = participants_.find(id);
  if (member == participants_.end()) {
    return "";
  }
  const auto topic = member->second.topics.find(number);
  return topic == member->second.topics.end() ? "" : topics_[topic->second.topic].name;
}

}  // namespace move_base_abstract
