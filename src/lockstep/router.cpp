#include "router.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace move_base_abstract {
namespace {

// What opens comes before, what closes after all that the same participant sent in the round.
constexpr std::uint32_t kFirstSub = 0;
constexpr std::uint32_t kLastSub = std::numeric_limits<std::uint32_t>::max();

bool fit(std::string_view advertised, std::string_view subscribed) {
  return subscribed == "*" || advertised == "*" || advertised == subscribed;
}

template <typename Entries>
auto findMember(Entries& entries, MemberId id) {
  return std::find_if(entries.begin(), entries.end(),
                      [id](const auto& entry) { return entry.member == id; });
}

/** @return what a hash table holds in an order that is that of every run. */
template <typename Value>
std::map<std::uint32_t, Value> inOrder(const std::unordered_map<std::uint32_t, Value>& table) {
  return {table.begin(), table.end()};
}

}  // namespace

MessageRouter::MessageRouter(Post post, Place place, Trace trace, const LockstepRules& rules)
    : post_(std::move(post)), place_(std::move(place)), trace_(std::move(trace)), rules_(rules) {}

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
    topics_.push_back({kept, {}, {}});
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
  const auto present = findMember(topic.publishers, by.sender);
  if (present != topic.publishers.end()) {
    checkNumber(by.sender, topic, present->topic, item.topic);
    if (present->md5 == publisher.md5 && present->latched == publisher.latched) {
      return;  // one more publisher in the same node: that is its own affair
    }
    stopAdvertising(by, local);
  }
  topic.publishers.push_back(publisher);
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
  const auto publisher = findMember(topic.publishers, by.sender);
  if (publisher == topic.publishers.end()) {
    return;
  }
  for (const Subscribed& subscriber : topic.subscribers) {
    if (fit(publisher->md5, subscriber.md5)) {
      closings_.push_back({true, subscriber.member, subscriber.topic, local.topic, by.sender,
                           place_(by.sender, kLastSub, by.number)});
    }
  }
  topic.publishers.erase(publisher);
  local.advertised = false;
}

void MessageRouter::act(const Action& by, const wire::Subscribe& item) {
  LocalTopic& local = declare(by.sender, item.topic, item.name);
  Topic& topic = topics_[local.topic];
  const Subscribed subscriber{by.sender, item.topic, keep(item.md5)};
  const auto present = findMember(topic.subscribers, by.sender);
  if (present != topic.subscribers.end()) {
    checkNumber(by.sender, topic, present->topic, item.topic);
    if (present->md5 == subscriber.md5) {
      return;  // one more subscriber in the same node: that is its own affair
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
  const auto subscriber = findMember(topic.subscribers, by.sender);
  if (subscriber == topic.subscribers.end()) {
    return;
  }
  for (const Advertised& publisher : topic.publishers) {
    if (fit(publisher.md5, subscriber->md5)) {
      closings_.push_back({false, publisher.member, publisher.topic, local.topic, by.sender,
                           place_(by.sender, kLastSub, by.number)});
    }
  }
  topic.subscribers.erase(subscriber);
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
  const MailOrder order = place_(by.sender, kFirstSub, by.number);
  post_(subscriber.member, {order,
                            wire::Publisher{subscriber.topic, publisher.member, publisher.type,
                                            publisher.md5, publisher.latched, publisher.definition},
                            !rules_.links_are_mail});
  post_(publisher.member,
        {order, wire::Subscriber{publisher.topic, subscriber.member}, !rules_.links_are_mail});
}

bool MessageRouter::linked(const Topic& topic, MemberId publisher, MemberId subscriber) const {
  const auto from = findMember(topic.publishers, publisher);
  const auto to = findMember(topic.subscribers, subscriber);
  return from != topic.publishers.end() && to != topic.subscribers.end() && fit(from->md5, to->md5);
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
      post_(closing.receiver, {closing.order, wire::NoPublisher{closing.number, closing.other},
                               !rules_.links_are_mail});
    } else {
      post_(closing.receiver, {closing.order, wire::NoSubscriber{closing.number, closing.other},
                               !rules_.links_are_mail});
    }
  }
  closings_.clear();
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
  for (const Subscribed& subscriber : topic.subscribers) {
    if ((item.target != 0 && item.target != subscriber.member) || !fit(local.md5, subscriber.md5)) {
      continue;
    }
    post_(subscriber.member,
          {order, wire::Deliver{subscriber.topic, by.sender, item.payload}, false});
    ++messages_;
    if (trace_) {
      receivers.push_back(subscriber.member);
    }
  }
  if (!receivers.empty()) {
    trace_({Delivery::Kind::kMessage, order, topic.name, by.sender, std::move(receivers),
            wire::CallStatus::kOk, item.payload});
  }
}

// ---- services --------------------------------------------------------------------------------

MessageRouter::Index MessageRouter::serviceOf(std::string_view name) {
  const std::string_view kept = keep(name);
  const auto index = static_cast<Index>(services_.size());
  const auto [known, fresh] = service_numbers_.try_emplace(kept, index);
  if (fresh) {
    services_.push_back({kept, {}, {}});
  }
  return known->second;
}

void MessageRouter::act(const Action& by, const wire::Serve& item) {
  if (item.name.empty()) {
    bad(by.sender, "SERVE must have a name, got an empty one");
  }
  const Index index = serviceOf(item.name);
  const auto [own, fresh] = participant(by.sender).services.try_emplace(item.service, index);
  if (!fresh && own->second != index) {
    bad(by.sender, "number " + std::to_string(item.service) + " is that of service '" +
                       std::string(services_[own->second].name) + "', got it for '" +
                       std::string(item.name) + "'");
  }
  Service& service = services_[index];
  const auto present = findMember(service.servers, by.sender);
  if (present != service.servers.end() && present->service != item.service) {
    bad(by.sender, "service '" + std::string(service.name) + "' has its number " +
                       std::to_string(present->service) + ", got a second one, " +
                       std::to_string(item.service));
  }
  if (!service.servers.empty() && service.servers.back().member != by.sender) {
    warnings_.push_back("service '" + std::string(service.name) + "' of '" +
                        participant(service.servers.back().member).name + "' is taken over by '" +
                        participant(by.sender).name + "'");
  }
  if (present != service.servers.end()) {
    service.servers.erase(present);
  }
  service.servers.push_back({by.sender, item.service, item.sub});
  const MailOrder order = place_(by.sender, item.sub, by.number);
  for (const MemberId watcher : service.watchers) {
    post_(watcher, {order, wire::Found{service.name}, false});
    participant(watcher).watched.erase(index);
  }
  service.watchers.clear();
}

void MessageRouter::act(const Action& by, const wire::Unserve& item) {
  auto& services = participant(by.sender).services;
  const auto own = services.find(item.service);
  if (own == services.end()) {
    bad(by.sender,
        "UNSERVE must name a service that it serves, got number " + std::to_string(item.service));
  }
  stopServing(by, own->second);
  services.erase(own);
}

void MessageRouter::stopServing(const Action& by, Index index) {
  Service& service = services_[index];
  const auto server = findMember(service.servers, by.sender);
  if (server != service.servers.end()) {
    service.servers.erase(server);
  }
  if (!rules_.dead_cancels_calls) {
    return;
  }
  const MailOrder order = place_(by.sender, kLastSub, by.number);
  for (auto call = calls_.begin(); call != calls_.end();) {
    if (call->second.service == index && call->second.server.member == by.sender) {
      answer(call->first.first, call->first.second, wire::CallStatus::kServerGone, {}, by.sender,
             service.name, order);
      call = calls_.erase(call);
    } else {
      ++call;
    }
  }
}

void MessageRouter::act(const Action& by, const wire::Call& item) {
  Participant& caller = participant(by.sender);
  if (item.number < caller.last_call) {
    bad(by.sender, "CALL must count up, got number " + std::to_string(item.number) + " after " +
                       std::to_string(caller.last_call - 1));
  }
  caller.last_call = std::uint64_t{item.number} + 1;
  const MailOrder order = place_(by.sender, item.sub, by.number);
  const auto known = service_numbers_.find(item.service);
  if (known == service_numbers_.end() || services_[known->second].servers.empty()) {
    answer(by.sender, item.number, wire::CallStatus::kNoServer, {}, 0, item.service, order);
    return;
  }
  const Service& service = services_[known->second];
  const Server& server = service.servers.back();
  calls_[{by.sender, item.number}] = {known->second, server};
  post_(server.member, {order, wire::CallIn{server.service, by.sender, item.number, item.request},
                        !rules_.calls_in_next_round});
  if (trace_) {
    trace_({Delivery::Kind::kCall,
            order,
            service.name,
            by.sender,
            {server.member},
            wire::CallStatus::kOk,
            item.request});
  }
}

void MessageRouter::act(const Action& by, const wire::Response& item) {
  const auto caller = participants_.find(item.caller);
  if (caller == participants_.end()) {
    return;  // it has gone meanwhile
  }
  if (item.number >= caller->second.last_call) {
    bad(by.sender, "RESPONSE must answer a call, got number " + std::to_string(item.number) +
                       " of '" + caller->second.name + "', which has not made it");
  }
  const auto call = calls_.find({item.caller, item.number});
  if (call == calls_.end() || call->second.server.member != by.sender) {
    return;  // cancelled meanwhile
  }
  const OpenCall open = call->second;
  calls_.erase(call);
  answer(item.caller, item.number, item.ok ? wire::CallStatus::kOk : wire::CallStatus::kError,
         item.bytes, by.sender, services_[open.service].name,
         place_(by.sender, open.server.sub, by.number));
}

void MessageRouter::answer(MemberId caller, std::uint32_t number, wire::CallStatus status,
                           std::string_view bytes, MemberId server, std::string_view service,
                           const MailOrder& order) {
  post_(caller, {order, wire::Answer{number, status, bytes}, false});
  if (trace_) {
    trace_({Delivery::Kind::kResponse, order, service, server, {caller}, status, bytes});
  }
}

void MessageRouter::act(const Action& by, const wire::Watch& item) {
  const Index index = serviceOf(item.service);
  Service& service = services_[index];
  if (!service.servers.empty()) {
    post_(by.sender, {place_(by.sender, kFirstSub, by.number), wire::Found{service.name}, false});
  } else if (participant(by.sender).watched.insert(index).second) {
    service.watchers.push_back(by.sender);
  }
}

// ---- departures ------------------------------------------------------------------------------

void MessageRouter::remove(MemberId id, std::uint64_t number) {
  const Action by{id, number};
  Participant& gone = participant(id);
  for (const auto& [own, local] : inOrder(gone.topics)) {
    stopAdvertising(by, gone.topics[own]);
    stopSubscribing(by, gone.topics[own]);
  }
  for (const auto& [own, index] : inOrder(gone.services)) {
    stopServing(by, index);
  }
  for (const Index index : gone.watched) {
    auto& watchers = services_[index].watchers;
    watchers.erase(std::remove(watchers.begin(), watchers.end(), id), watchers.end());
  }
  const auto first = calls_.lower_bound({id, 0});
  const auto last = calls_.upper_bound({id, std::numeric_limits<std::uint32_t>::max()});
  calls_.erase(first, last);
  participants_.erase(id);
}

}  // namespace move_base_abstract
