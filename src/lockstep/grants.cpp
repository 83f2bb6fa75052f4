// Sends the grants of a round to the participants.

#include "grants.h"

#include <cstddef>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "clock/number_text.h"

namespace move_base_abstract {
namespace {

constexpr std::size_t kMostItems = wire::kLargestFrame - 64;  // bytes; the rest is the grant's own
constexpr std::size_t kKeptGrant = 4096;  // bytes, to show the latest grant of a silent participant

/** @return the topic by which a thread of the receiver is woken; see Connections::send(). */
std::optional<std::uint32_t> topicOf(const std::vector<Mail>& mail) {
  if (mail.empty()) {
    return 0;
  }
  const auto* const first = std::get_if<wire::Deliver>(&mail.front().item);
  return first == nullptr ? std::nullopt : std::optional<std::uint32_t>(first->topic);
}

}  // namespace

void Grants::send(const std::vector<LockstepRounds::Grant>& grants) {
  if (!grants.empty()) {
    granted_.clear();
  }
  for (const LockstepRounds::Grant& grant : grants) {
    const auto member = run_.members.find(grant.member);
    if (member == run_.members.end()) {
      continue;
    }
    if (grant.is_played) {
      play(grant, member->second);
    } else {
      sendOne(grant, member->second);
    }
  }
}

/** @brief Make the turns that are played for @p member: the one that is due, or those of a window.
 */
void Grants::play(const LockstepRounds::Grant& grant, SessionMember& member) {
  run_.changed.add(grant.member, member);
  if (!run_.rounds.windows().areThere()) {
    member.turn = member.played.take();
  } else {
    member.played.takeUntil(grant.time, &member.walked);
    if (run_.rounds.members().find(grant.member)->owes) {
      return;  // it has a turn of its own in this window, too
    }
    run_.rounds.windows().walked(grant.member, member.walked.back().at);
  }
  run_.rounds.members().playNext(grant.member, member.played.next());
}

void Grants::sendOne(const LockstepRounds::Grant& grant, SessionMember& member) {
  std::string items;
  if (const RoundWindows& windows = run_.rounds.windows(); windows.areThere()) {
    wire::append(items, windows.latestWindow());
  }
  if (grant.happened) {
    wire::append(items, wire::Happened{*grant.happened});
  }
  if (std::exchange(member.has_changed, false)) {
    wire::append(items, wire::Changed{});
  }
  items += grant.later;
  for (const Mail& mail : grant.mail) {
    wire::append(items, mail.item);
  }
  if (items.size() > kMostItems) {
    too_much_ = quote(member.name) + " is to be handed " + std::to_string(items.size()) +
                " bytes at once" + run_.text.at() + ", in " +
                countText(grant.mail.size(), "piece") + "; allowed: " + std::to_string(kMostItems) +
                ". This happens if each message leads to more messages while time stands still";
    return;
  }
  granted_.push_back(grant.member);
  member.played.stop();
  member.where.clear();
  member.silence_told = false;
  member.granted.assign(items, 0, items.size() <= kKeptGrant ? items.size() : 0);
  run_.connections.send(member.connection,
                        wire::encodeGrant({grant.round, grant.time, grant.microstep, {}}, items),
                        topicOf(grant.mail));
}

ConnectionId Grants::lastAwaited() {
  while (!granted_.empty()) {
    const auto member = run_.members.find(granted_.back());
    const MemberState* const state = run_.rounds.members().find(granted_.back());
    if (member != run_.members.end() && state != nullptr && state->owes) {
      return member->second.connection;
    }
    granted_.pop_back();
  }
  return 0;
}

}  // namespace move_base_abstract
