// The second part of the router: services, calls, and the departure of a participant.
#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "router.h"
#include "router_parts.h"

namespace move_base_abstract {
namespace {

/** @return the entries of a hash table in an order that is the same in every run. */
template <typename Value>
std::map<std::uint32_t, Value> inOrder(const std::unordered_map<std::uint32_t, Value>& table) {
  return {table.begin(), table.end()};
}

}  // namespace

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
  const auto present = router::findMember(service.servers, by.sender);
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
    post_(watcher, {order, wire::Found{service.name}});
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
  const auto server = router::findMember(service.servers, by.sender);
  if (server != service.servers.end()) {
    service.servers.erase(server);
  }
  dropCalls(service.name, by.sender);
  const MailOrder order = place_(by.sender, router::kLastSub, by.number);
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
  calls_[{by.sender, item.number}] = {known->second, server, item.sub};
  if (carriage_ != nullptr && !arrivesAtOnce(by, item, service, server)) {
    return;
  }
  post_(server.member, {order, wire::CallIn{server.service, by.sender, item.number, item.request}});
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
    return;  // the caller has gone meanwhile
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
  if (carriage_ != nullptr && !arrivesAtOnce(by, item, open)) {
    return;
  }
  answer(item.caller, item.number, item.ok ? wire::CallStatus::kOk : wire::CallStatus::kError,
         item.bytes, by.sender, services_[open.service].name,
         place_(by.sender, open.server.sub, by.number));
}

void MessageRouter::answer(MemberId caller, std::uint32_t number, wire::CallStatus status,
                           std::string_view bytes, MemberId server, std::string_view service,
                           const MailOrder& order) {
  post_(caller, {order, wire::Answer{number, status, bytes}});
  if (trace_) {
    trace_({Delivery::Kind::kResponse, order, service, server, {caller}, status, bytes});
  }
}

void MessageRouter::act(const Action& by, const wire::Watch& item) {
  const Index index = serviceOf(item.service);
  Service& service = services_[index];
  if (!service.servers.empty()) {
    post_(by.sender, {place_(by.sender, router::kFirstSub, by.number), wire::Found{service.name}});
  } else if (participant(by.sender).watched.insert(index).second) {
    service.watchers.push_back(by.sender);
  }
}

std::size_t MessageRouter::watches() const {
  std::size_t count = 0;
  for (const Service& service : services_) {
    count += service.watchers.size();
  }
  return count;
}

MessageRouter::Wanted MessageRouter::wanted() const {
  Wanted found;
  for (const Service& service : services_) {
    if (!service.watchers.empty()) {
      found.services.emplace_back(service.name);
    }
  }
  found.is_any = !found.services.empty() ||
                 std::any_of(topics_.begin(), topics_.end(), [](const Topic& topic) {
                   return topic.publishers.empty() && !topic.subscribers.empty();
                 });
  return found;
}

// ---- departures ------------------------------------------------------------------------------

void MessageRouter::remove(MemberId id, std::uint64_t number) {
  const Action by{id, number};
  Participant& gone = participant(id);
  goals_.remove(id);
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
  dropCallsOf(id);
  participants_.erase(id);
}

}  // namespace move_base_abstract
