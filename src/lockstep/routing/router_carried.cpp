// The third part of the router: mail that arrives later, or never.
#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
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
constexpr std::string_view kRunEnded = "the run ended while it was under way";
constexpr std::string_view kNotHeard = "its receiver has no use for it when it arrives";

/** @return @p item with @p bytes as its content. */
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

Passage MessageRouter::passage(Passage::Kind kind, const Action& by, std::uint32_t sub,
                               MemberId receiver, std::uint32_t receiver_sub, std::string_view name,
                               std::string_view bytes) const {
  return {kind,
          by.sender,
          receiver,
          participants_.at(by.sender).name,
          participants_.at(receiver).name,
          name,
          {},
          bytes.size(),
          false,
          place_(by.sender, sub, by.number),
          receiver_sub};
}

bool MessageRouter::arrivesAtOnce(const Action& by, const wire::Send& item, const Topic& topic,
                                  const wire::Deliver& deliver, MemberId receiver) {
  Passage message =
      passage(Passage::Kind::kMessage, by, item.sub, receiver,
              router::findMember(topic.subscribers, receiver)->sub, topic.name, item.payload);
  message.type = typeOf(topic, by.sender);
  message.is_latched = router::findMember(topic.publishers, by.sender)->latched;
  return carry(message, by.number, deliver, item.payload);
}

bool MessageRouter::arrivesAtOnce(const Action& by, const wire::Call& item, const Service& service,
                                  const Server& server) {
  return carry(passage(Passage::Kind::kCall, by, item.sub, server.member, server.sub, service.name,
                       item.request),
               by.number, wire::CallIn{server.service, by.sender, item.number, item.request},
               item.request, item.number);
}

bool MessageRouter::arrivesAtOnce(const Action& by, const wire::Response& item,
                                  const OpenCall& call) {
  const auto status = item.ok ? wire::CallStatus::kOk : wire::CallStatus::kError;
  return carry(passage(Passage::Kind::kResponse, by, call.server.sub, item.caller, call.sub,
                       services_[call.service].name, item.bytes),
               by.number, wire::Answer{item.number, status, item.bytes}, item.bytes, item.number);
}

/**
 * @brief Hold an item until it arrives, or note that it is lost. The caller of a service learns of
 * a loss as of a broken connection.
 * @return whether the item arrives at once. Then nothing is done.
 */
bool MessageRouter::carry(const Passage& passage, std::uint64_t number, const wire::GrantItem& item,
                          std::string_view bytes, std::uint32_t call) {
  const Carried carried = carriage_->carry(passage);
  is_lost_ = !carried.lost.empty();
  if (!is_lost_ && !carriage_->isLater(carried.due)) {
    return true;
  }
  Held held = heldOf(passage, number, item, bytes);
  held.ticket = carried.ticket;
  if (is_lost_) {
    traceHeld(held, carried.lost);
    fail(held, call, carried.due);
  } else {
    carriage_->held.add(carried.due, std::move(held));
  }
  return false;
}

/** @brief Tell the caller if a call or response is lost. Nothing happens for a message. */
void MessageRouter::fail(const Held& held, std::uint32_t call, Nanoseconds due) {
  if (held.kind == Passage::Kind::kMessage) {
    return;
  }
  const bool is_call = held.kind == Passage::Kind::kCall;
  const MemberId caller = is_call ? held.sender : held.receiver;
  const MemberId server = is_call ? held.receiver : held.sender;
  calls_.erase({caller, call});
  const wire::Answer failed{call, wire::CallStatus::kServerGone, {}};
  if (carriage_->isLater(due)) {
    Held back = held;
    back.kind = Passage::Kind::kResponse;
    std::tie(back.sender, back.receiver) = std::pair(server, caller);
    back.sender_name = participants_.at(server).name;
    back.bytes = std::make_shared<const std::string>();
    back.item = failed;
    carriage_->held.add(due, std::move(back));
  } else {
    answer(caller, call, failed.status, {}, server, held.name,
           place_(held.sender, router::kFirstSub, held.number));
  }
}

// ---- mail that waits until its carrier decides -----------------------------------------------

void MessageRouter::decide(std::uint64_t ticket, const Carried& carried) {
  std::optional<Held> held = carriage_->held.takeWaiting(ticket);
  if (!held) {
    return;
  }
  if (carried.lost.empty()) {
    carriage_->held.add(carried.due, *std::move(held));
    return;
  }
  traceHeld(*held, carried.lost);
  if (held->kind == Passage::Kind::kMessage) {
    if (topics_[topic_numbers_.at(held->name)].part == OpenGoals::Part::kGoal) {
      goals_.lost(held->name, *held->bytes);
    }
    return;
  }
  const auto* call = std::get_if<wire::CallIn>(&held->item);
  fail(*held, call != nullptr ? call->number : std::get<wire::Answer>(held->item).number,
       carried.due);
}

// ---- arriving --------------------------------------------------------------------------------

void MessageRouter::arrive() {
  while (late_links_.nextDue() != kNever && !carriage_->isLater(late_links_.nextDue())) {
    const LateLink late = late_links_.take();
    const Topic& topic = topics_[late.link.topic];
    open({late.sender, late.number}, *router::findMember(topic.publishers, late.link.publisher),
         *router::findMember(topic.subscribers, late.link.subscriber));
  }
  for (const Held& held : carriage_->arrive()) {
    arriveOne(held);
  }
}

/** @return whether a link that is made now is up later. Then it is noted. */
bool MessageRouter::isLate(const Action& by, const Topic& topic, const Link& link) {
  const Nanoseconds due = late_links_.dueOf(participant(link.publisher).name,
                                            participant(link.subscriber).name, topic.name);
  if (due == 0) {
    return false;
  }
  late_links_.add(due, {link, by.sender, by.number});
  return true;
}

/**
 * @brief Post an item that arrives. Its place follows from the sender's count alone. So the items
 * of one link keep their order, also if they were sent in several rounds or by several robots of a
 * fleet.
 */
void MessageRouter::arriveOne(const Held& held) {
  Keep keep = Keep::kNot;
  if (held.kind == Passage::Kind::kMessage) {
    const Topic& topic = topics_[topic_numbers_.at(held.name)];
    const auto subscriber = router::findMember(topic.subscribers, held.receiver);
    if (subscriber == topic.subscribers.end() || subscriber->delivery == wire::Delivery::kNothing) {
      traceHeld(held, kNotHeard);
      return;
    }
    keep = router::keepFor(subscriber->delivery, subscriber->is_stored);
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

// ---- mail that does not arrive ---------------------------------------------------------------

void MessageRouter::drop(const std::function<bool(const Held&)>& is_meant, std::string_view why) {
  if (carriage_ == nullptr || carriage_->held.empty()) {
    return;
  }
  for (const Held& held : carriage_->held.drop(is_meant)) {
    traceHeld(held, why);
  }
}

void MessageRouter::loseCarried() {
  drop([](const Held&) { return true; }, kRunEnded);
}

/**
 * @brief Drop the messages of a link that closes: those of @p sender and to @p receiver; 0: any.
 */
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

/** @brief Drop the calls to a server that stops. stopServing() tells their callers. */
void MessageRouter::dropCalls(std::string_view service, MemberId server) {
  drop(
      [=](const Held& held) {
        return held.kind == Passage::Kind::kCall && held.name == service && held.receiver == server;
      },
      kNoServer);
}

/** @brief Drop the calls of a participant that has gone, and the answers to it. */
void MessageRouter::dropCallsOf(MemberId caller) {
  drop(
      [=](const Held& held) {
        return (held.kind == Passage::Kind::kCall && held.sender == caller) ||
               (held.kind == Passage::Kind::kResponse && held.receiver == caller);
      },
      kNoCaller);
}

}  // namespace move_base_abstract
