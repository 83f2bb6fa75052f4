// The router's third part: what arrives later, and what does not.
#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "router.h"
#include "router_parts.h"

namespace move_base_abstract {
namespace {

constexpr std::string_view kLinkClosed = "the link was closed while it was under way";
constexpr std::string_view kNoServer = "its server stopped serving while it was under way";
constexpr std::string_view kNoCaller = "its caller left while it was under way";
constexpr std::string_view kNotHeard = "its receiver has no use for it when it arrives";

/** @return @p item with @p bytes as what it carries. */
wire::GrantItem pointedAt(wire::GrantItem item, std::string_view bytes) {
  if (auto* message = std::get_if<wire::Deliver>(&item)) {
    message->payload = bytes;
  } else if (auto* call = std::get_if<wire::CallIn>(&item)) {
    call->request = bytes;
  } else if (auto* answer = std::get_if<wire::Answer>(&item)) {
    answer->bytes = bytes;
  }
  return item;
}

wire::CallStatus statusOf(const wire::GrantItem& item) {
  const auto* answer = std::get_if<wire::Answer>(&item);
  return answer == nullptr ? wire::CallStatus::kOk : answer->status;
}

Held heldOf(const Passage& passage, std::uint64_t number, const wire::GrantItem& item,
            std::string_view bytes) {
  Held held{passage.kind,
            passage.sender,
            passage.receiver,
            number,
            passage.name,
            passage.type,
            std::string(passage.sender_name),
            std::make_shared<const std::string>(bytes),
            item};
  held.item = pointedAt(item, *held.bytes);
  return held;
}

}  // namespace

// ---- setting out -----------------------------------------------------------------------------

Passage MessageRouter::passage(Passage::Kind kind, const Action& by, MemberId receiver,
                               std::string_view name, std::string_view bytes) const {
  return {kind,
          by.sender,
          receiver,
          participants_.at(by.sender).name,
          participants_.at(receiver).name,
          name,
          {},
          bytes.size(),
          false};
}

bool MessageRouter::arrivesAtOnce(const Action& by, const wire::Send& item, const Topic& topic,
                                  const wire::Deliver& deliver, MemberId receiver) {
  Passage message = passage(Passage::Kind::kMessage, by, receiver, topic.name, item.payload);
  message.type = typeOf(topic, by.sender);
  message.is_latched = router::findMember(topic.publishers, by.sender)->latched;
  return carry(message, by.number, deliver, item.payload);
}

bool MessageRouter::arrivesAtOnce(const Action& by, const wire::Call& item, const Service& service,
                                  const Server& server) {
  return carry(passage(Passage::Kind::kCall, by, server.member, service.name, item.request),
               by.number, wire::CallIn{server.service, by.sender, item.number, item.request},
               item.request, item.number);
}

bool MessageRouter::arrivesAtOnce(const Action& by, const wire::Response& item,
                                  const Service& service) {
  const auto status = item.ok ? wire::CallStatus::kOk : wire::CallStatus::kError;
  return carry(passage(Passage::Kind::kResponse, by, item.caller, service.name, item.bytes),
               by.number, wire::Answer{item.number, status, item.bytes}, item.bytes, item.number);
}

/**
 * @brief Keep it until it arrives, or say that it is lost; the caller of a service is told of that
 * as of a connection that broke.
 * @return whether it arrives at once: nothing is done then.
 */
bool MessageRouter::carry(const Passage& passage, std::uint64_t number, const wire::GrantItem& item,
                          std::string_view bytes, std::uint32_t call) {
  const Carried carried = carriage_->carry(passage);
  if (carried.lost.empty()) {
    if (carriage_->isLater(carried.due)) {
      carriage_->held.add(carried.due, heldOf(passage, number, item, bytes));
      return false;
    }
    return true;
  }
  traceHeld(heldOf(passage, number, item, bytes), carried.lost);
  if (passage.kind == Passage::Kind::kMessage) {
    return false;
  }
  const bool is_call = passage.kind == Passage::Kind::kCall;
  const MemberId caller = is_call ? passage.sender : passage.receiver;
  const MemberId server = is_call ? passage.receiver : passage.sender;
  calls_.erase({caller, call});
  const wire::Answer failed{call, wire::CallStatus::kServerGone, {}};
  if (carriage_->isLater(carried.due)) {
    Passage back = passage;
    back.kind = Passage::Kind::kResponse;
    std::tie(back.sender, back.receiver) = std::pair(server, caller);
    back.sender_name = participants_.at(server).name;
    carriage_->held.add(carried.due, heldOf(back, number, failed, {}));
  } else {
    answer(caller, call, failed.status, {}, server, passage.name,
           place_(passage.sender, router::kFirstSub, number));
  }
  return false;
}

// ---- arriving --------------------------------------------------------------------------------

void MessageRouter::arrive() {
  for (const Held& held : carriage_->arrive()) {
    arriveOne(held);
  }
}

/** @brief Its place is that of the sender's count alone: what one link carries keeps its order,
 * also where it was sent in several rounds, of several robots of a fleet. */
void MessageRouter::arriveOne(const Held& held) {
  Keep keep = Keep::kNot;
  if (held.kind == Passage::Kind::kMessage) {
    const Topic& topic = topics_[topic_numbers_.at(held.name)];
    const auto subscriber = router::findMember(topic.subscribers, held.receiver);
    if (subscriber == topic.subscribers.end() || subscriber->hears == wire::Hearing::kNothing) {
      traceHeld(held, kNotHeard);
      return;
    }
    keep = router::keepFor(subscriber->hears, subscriber->is_stored);
    ++messages_;
    if (topic.part == OpenGoals::Part::kResult &&
        goals_.clientOf(topic.name, *held.bytes) == held.receiver) {
      goals_.answered(topic.name, *held.bytes);
    }
  }
  post_(held.receiver, {place_(held.sender, router::kFirstSub, held.number), held.item, keep});
  traceHeld(held, {});
}

void MessageRouter::traceHeld(const Held& held, std::string_view lost) {
  if (trace_) {
    trace_({held.kind,
            place_(held.sender, router::kFirstSub, held.number),
            held.name,
            held.sender,
            {held.receiver},
            statusOf(held.item),
            *held.bytes,
            held.type,
            lost,
            held.sender_name});
  }
}

// ---- what does not arrive --------------------------------------------------------------------

void MessageRouter::drop(const std::function<bool(const Held&)>& is_meant, std::string_view why) {
  if (carriage_ == nullptr || carriage_->held.empty()) {
    return;
  }
  for (const Held& held : carriage_->held.drop(is_meant)) {
    traceHeld(held, why);
  }
}

/** @brief A link closes: @p sender's to all, or those to @p receiver; 0: any. */
void MessageRouter::dropMessages(const Topic& topic, MemberId sender, MemberId receiver) {
  const std::string_view name = topic.name;
  drop(
      [=](const Held& held) {
        return held.kind == Passage::Kind::kMessage && held.name == name &&
               (sender == 0 || held.sender == sender) &&
               (receiver == 0 || held.receiver == receiver);
      },
      kLinkClosed);
}

/** @brief Their callers are told so by stopServing(). */
void MessageRouter::dropCalls(std::string_view service, MemberId server) {
  drop(
      [=](const Held& held) {
        return held.kind == Passage::Kind::kCall && held.name == service && held.receiver == server;
      },
      kNoServer);
}

/** @brief The calls of who has gone, and what it would have been answered. */
void MessageRouter::dropCallsOf(MemberId caller) {
  drop(
      [=](const Held& held) {
        return (held.kind == Passage::Kind::kCall && held.sender == caller) ||
               (held.kind == Passage::Kind::kResponse && held.receiver == caller);
      },
      kNoCaller);
}

}  // namespace move_base_abstract
