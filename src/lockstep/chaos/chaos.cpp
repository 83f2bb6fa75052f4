#include "chaos.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>

#include "clock/number_text.h"
#include "draws.h"

namespace move_base_abstract::chaos {
namespace {

enum class Line { kTopic, kListener, kService, kAnswer, kOther };  // kinds of connections
using Connection = std::tuple<Line, std::uint32_t, std::uint32_t>;

/** @return the connection of the receiver by which @p item has come. */
Connection connectionOf(const wire::GrantItem& item) {
  if (const auto* one = std::get_if<wire::Deliver>(&item)) {
    return {Line::kTopic, one->topic, one->sender};
  }
  if (const auto* one = std::get_if<wire::Publisher>(&item)) {
    return {Line::kTopic, one->topic, one->sender};
  }
  if (const auto* one = std::get_if<wire::NoPublisher>(&item)) {
    return {Line::kTopic, one->topic, one->sender};
  }
  if (const auto* one = std::get_if<wire::CallIn>(&item)) {
    return {Line::kService, one->service, one->caller};
  }
  if (const auto* one = std::get_if<wire::Answer>(&item)) {
    return {Line::kAnswer, one->number, 0};
  }
  if (const auto* one = std::get_if<wire::Subscriber>(&item)) {
    return {Line::kListener, one->topic, one->receiver};
  }
  if (const auto* one = std::get_if<wire::NoSubscriber>(&item)) {
    return {Line::kListener, one->topic, one->receiver};
  }
  if (const auto* one = std::get_if<wire::DeliveryChosen>(&item)) {
    return {Line::kListener, one->topic, one->receiver};
  }
  return {Line::kOther, 0, 0};
}

/**
 * @return whether @p item may change places with others: a message, a call or an answer, but no
 * news of connections.
 */
bool mayMove(const wire::GrantItem& item) {
  return std::holds_alternative<wire::Deliver>(item) ||
         std::holds_alternative<wire::CallIn>(item) || std::holds_alternative<wire::Answer>(item);
}

/**
 * @brief Put the mail of each connection into the order in which it was posted, in the places that
 * this connection's mail has in @p sorted.
 */
void keepPosted(const std::vector<Mail>& posted, std::vector<Mail>& sorted) {
  std::map<Connection, std::vector<const Mail*>> lines;
  for (const Mail& mail : posted) {
    lines[connectionOf(mail.item)].push_back(&mail);
  }
  std::map<Connection, std::size_t> next;
  for (Mail& mail : sorted) {
    const Connection line = connectionOf(mail.item);
    mail = *lines[line][next[line]++];
  }
}

}  // namespace

// ---- order -----------------------------------------------------------------------------------

void Order::arrangeTurns(std::vector<MemberId>& ids, const std::function<bool(MemberId)>& matters) {
  are_turns_moved_ = false;
  std::vector<MemberId> placed;
  for (const MemberId id : ids) {
    const bool any = std::any_of(placed.begin(), placed.end(), matters);
    const std::size_t most = matters(id) || any ? placed.size() : 0;
    std::size_t ahead = 0;
    if (most > 0) {
      ahead = decisions_.draw(mixed({hashOf("turns"), hashOf(names_.node(id))}), most);
    }
    const auto at = placed.end() - static_cast<std::ptrdiff_t>(ahead);
    if (ahead > 0) {
      are_turns_moved_ = true;
      const MemberId other = *at;
      decisions_.note(rounds_.now(), "turns", [&] {
        return "the turn of " + names_.node(id) + " took effect before that of " +
               names_.node(other);
      });
    }
    placed.insert(at, id);
  }
  ids = std::move(placed);
}

void Order::arrangeMail(MemberId receiver, std::vector<Mail>& mail) {
  std::vector<Mail> sorted = mail;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [this](const Mail& a, const Mail& b) { return isBefore(a.order, b.order); });
  if (are_turns_moved_) {
    keepPosted(mail, sorted);
  }
  mail.clear();
  for (const Mail& one : sorted) {
    placeMail(receiver, mail, one);
  }
}

/** @brief Put @p mail behind the mail in @p placed, or ahead of some of it. */
void Order::placeMail(MemberId receiver, std::vector<Mail>& placed, const Mail& mail) {
  std::size_t most = 0;
  if (mayMove(mail.item)) {
    const Connection own = connectionOf(mail.item);
    while (most < placed.size()) {
      const Mail& other = placed[placed.size() - 1 - most];
      if (!mayMove(other.item) || connectionOf(other.item) == own) {
        break;
      }
      ++most;
    }
  }
  std::size_t ahead = 0;
  if (most > 0) {
    ahead = decisions_.draw(linkOf(receiver, mail), most);
  }
  const auto at = placed.end() - static_cast<std::ptrdiff_t>(ahead);
  if (ahead > 0) {
    decisions_.note(rounds_.now(), "order", [&] {
      const std::string others = ahead > 1 ? " and " + std::to_string(ahead - 1) + " more" : "";
      return said(receiver, mail) + " reached " + names_.node(receiver) + " before " +
             said(receiver, *at) + others;
    });
  }
  placed.insert(at, mail);
}

std::string Order::said(MemberId receiver, const Mail& mail) const {
  if (const auto* one = std::get_if<wire::Deliver>(&mail.item)) {
    return names_.node(one->sender) + "'s message on " + names_.topic(receiver, one->topic);
  }
  if (const auto* one = std::get_if<wire::CallIn>(&mail.item)) {
    return names_.node(one->caller) + "'s call";
  }
  return "the answer to its call";
}

std::uint64_t Order::linkOf(MemberId receiver, const Mail& mail) const {
  std::uint64_t from = hashOf("answer");
  if (const auto* one = std::get_if<wire::Deliver>(&mail.item)) {
    from = mixed({hashOf("message"), hashOf(names_.node(one->sender)),
                  hashOf(names_.topic(receiver, one->topic))});
  } else if (const auto* call = std::get_if<wire::CallIn>(&mail.item)) {
    from = mixed({hashOf("call"), hashOf(names_.node(call->caller)), call->service});
  }
  return mixed({hashOf("order"), hashOf(names_.node(receiver)), from});
}

// ---- delays ----------------------------------------------------------------------------------

Carried Delays::carry(const Passage& passage) {
  if (passage.sender == passage.receiver) {
    return {passage.from};
  }
  const std::uint64_t link =
      mixed({hashOf("delay"), static_cast<std::uint64_t>(passage.kind), hashOf(passage.sender_name),
             hashOf(passage.receiver_name), hashOf(passage.name)});
  const auto delay =
      static_cast<Nanoseconds>(decisions_.draw(link, static_cast<std::uint64_t>(most_)));
  Nanoseconds& last = last_[link];
  const Nanoseconds due = addSaturated(passage.from, delay);
  const bool waits = last > due;  // for an earlier message of its connection
  last = std::max(last, due);
  if (delay > 0) {
    decisions_.note(passage.from, "delay", [&] {
      static const char* const kinds[] = {"message on ", "call of ", "answer to a call of "};
      return std::string(passage.sender_name) + "'s " +
             kinds[static_cast<std::size_t>(passage.kind)] + std::string(passage.name) +
             " was under way to " + std::string(passage.receiver_name) + " for " +
             secondsText(delay) +
             (waits ? ", and came behind an earlier one, after " + secondsText(last - passage.from)
                    : "");
    });
  }
  return {last};
}

}  // namespace move_base_abstract::chaos
