#include "status.h"

#include <algorithm>
#include <tuple>

namespace move_base_abstract {
namespace {

constexpr std::size_t kMostTold = 10;

}  // namespace

const char* phaseName(LockstepPhase phase) {
  switch (phase) {
    case LockstepPhase::kWaitingForParticipants:
      return "waiting_for_participants";
    case LockstepPhase::kRunning:
      return "running";
    case LockstepPhase::kWaiting:
      return "waiting";
    case LockstepPhase::kLimited:
      return "limited";
    case LockstepPhase::kPaused:
      return "paused";
    case LockstepPhase::kStopped:
      return "stopped";
    case LockstepPhase::kIdle:
      return "idle";
    case LockstepPhase::kDeadlock:
      return "deadlock";
    case LockstepPhase::kZeroDelayLoop:
      return "zero_delay_loop";
    case LockstepPhase::kEnded:
      return "ended";
  }
  return "unknown";
}

std::string StatusText::at() const { return " at " + secondsText(rounds_.now()); }

std::string StatusText::nameOf(MemberId id) const {
  const auto found = members_.find(id);
  return found == members_.end() ? "" : found->second.name;
}

std::string StatusText::owed(const MemberState& member) const {
  std::vector<std::string> parts;
  if (member.granted_mail > 0) {
    parts.push_back(countText(member.granted_mail, "message"));
  }
  if (member.granted_due) {
    parts.push_back("wake-up due");
  }
  return "the report of round " + std::to_string(member.round) +
         (parts.empty() ? "" : " (" + joined(parts) + ")");
}

/** @return for each member with threads that wait without a timeout: how many, and what for. */
std::vector<std::string> StatusText::waiting() const {
  std::vector<std::string> parts;
  for (const LockstepStatus::Participant& member : participants()) {
    const auto count = member.open + rounds_.members().find(member.id)->idle;
    if (count > 0) {
      parts.push_back(quote(member.name) + " has " + countText(count, "waiting thread") +
                      (member.waits_for.empty() ? "" : " (" + member.waits_for + ")"));
    }
  }
  return parts;
}

/** @return the same as one text, together with the goals that have no answer. */
std::string StatusText::stuck(const OpenGoals& goals) const {
  std::vector<std::string> parts = waiting();
  for (const auto& [goal, count] : goals.byAction()) {
    parts.push_back(quoted(goal.first) + " has " + countText(count, "goal") + " open on " +
                    goal.second);
  }
  return joined(parts);
}

std::vector<LockstepStatus::OpenGoals> StatusText::openGoals(const OpenGoals& goals) const {
  std::vector<LockstepStatus::OpenGoals> open;
  for (const auto& [goal, count] : goals.byAction()) {
    open.push_back({nameOf(goal.first), goal.second, count});
  }
  std::sort(open.begin(), open.end(), [](const auto& a, const auto& b) {
    return std::tie(a.client, a.action) < std::tie(b.client, b.action);
  });
  return open;
}

std::string StatusText::idle() const {
  const std::vector<std::string> parts = waiting();
  return "idle" + at() + ": no participant wants to wake up" +
         (parts.empty() ? "" : "; waiting for work: " + joined(parts));
}

std::string StatusText::latestRound() const {
  std::vector<std::string> names;
  for (const MemberId id : rounds_.latestRound()) {
    if (members_.count(id) != 0) {
      names.push_back(quoted(id));
    }
  }
  return joined(names);
}

std::string StatusText::told(MemberId id, const MessageRouter& router) const {
  const auto member = members_.find(id);
  if (member == members_.end() || member->second.granted.empty()) {
    return "";
  }
  const std::string frame = wire::encodeGrant({0, 0, 0, {}}, member->second.granted);
  const auto grant =
      std::get<wire::Grant>(wire::decodeFromMaster(std::string_view(frame).substr(4)));
  std::vector<std::string> parts;
  for (const wire::GrantItem& item : grant.items) {
    std::string text =
        std::visit([&](const auto& decoded) { return describe(decoded, id, router); }, item);
    if (!text.empty()) {
      parts.push_back(std::move(text));
    }
  }
  const std::size_t first = parts.size() > kMostTold ? parts.size() - kMostTold : 0;
  return joined({parts.begin() + static_cast<std::ptrdiff_t>(first), parts.end()});
}

std::string StatusText::describe(const wire::Deliver& item, MemberId id,
                                 const MessageRouter& router) const {
  return "a message on " + std::string(router.topicName(id, item.topic)) + " of " +
         quoted(item.sender);
}

std::string StatusText::describe(const wire::CallIn& item, MemberId, const MessageRouter&) const {
  return "a call by " + quoted(item.caller);
}

std::string StatusText::describe(const wire::Answer&, MemberId, const MessageRouter&) const {
  return "the answer to a call";
}

std::vector<LockstepStatus::Waiting> StatusText::waitingFor(Nanoseconds began,
                                                            const Interruption& interruption,
                                                            const MessageRouter& router) const {
  std::vector<LockstepStatus::Waiting> waiting;
  if (!rounds_.started()) {
    for (const std::string& name : rounds_.missing()) {
      waiting.push_back({name, began, "its HELLO" + departureOf(name), "", ""});
    }
    return waiting;
  }
  for (const auto& [id, since] : interruption.ending()) {
    waiting.push_back({nameOf(id), since, "its end, which a signal asked for", "", ""});
  }
  for (const MemberId id : rounds_.latestRound()) {
    const MemberState* member = rounds_.members().find(id);
    if (member && member->owes && !interruption.concerns(id)) {
      waiting.push_back({member->name, member->granted_wall, owed(*member), members_.at(id).where,
                         told(id, router)});
    }
  }
  return waiting;
}

std::vector<LockstepStatus::Participant> StatusText::participants() const {
  std::vector<MemberId> ids;
  for (const auto& [id, member] : members_) {
    if (!member.departing) {
      ids.push_back(id);
    }
  }
  rounds_.members().sort(ids);
  std::vector<LockstepStatus::Participant> participants;
  for (const MemberId id : ids) {
    const SessionMember& member = members_.at(id);
    const MemberState& state = *rounds_.members().find(id);
    participants.push_back({id, member.name, member.node_uri, state.rank,
                            state.next == kNever ? std::nullopt : std::optional(state.next),
                            state.open, member.waits_for, member.tells, state.knocked,
                            state.mail.size(), state.owes});
  }
  return participants;
}

std::string StatusText::standstill(LockstepPhase phase, const OpenGoals& goals) const {
  switch (phase) {
    case LockstepPhase::kDeadlock:
      return "deadlock" + at() + ": no participant wants to wake up, but " + stuck(goals);
    case LockstepPhase::kZeroDelayLoop:
      return "zero-delay loop" + at() + ": " + std::to_string(rounds_.clock().microstep) +
             " microsteps at one instant, the last of them by " + latestRound();
    default:
      return "";
  }
}

std::string StatusText::departureOf(const std::string& name) const {
  const auto found = departures_.find(name);
  return found == departures_.end() ? "" : ": it was there, and " + found->second;
}

std::string StatusText::missing() const {
  std::vector<std::string> names;
  for (const std::string& name : rounds_.missing()) {
    names.push_back(quote(name) + departureOf(name));
  }
  return joined(names) + " (" + countText(members_.size(), "participant") + " there)";
}

}  // namespace move_base_abstract
