#include "rounds.h"

#include <algorithm>
#include <utility>

namespace move_base_abstract {

LockstepRounds::LockstepRounds(const LockstepSettings& settings)
    : settings_(checkedSettings(settings)),
      clock_{std::max<Nanoseconds>(1, toNanoseconds(settings.start_time))},
      mail_(members_, clock_, settings.lookahead > 0.0, settings.keep_unread),
      windows_(members_, clock_, mail_, outside_, toNanoseconds(settings.lookahead)),
      gate_(settings.limit, settings.start_paused, settings.start_stopped),
      watch_(members_, toNanoseconds(settings.silence_limit)) {}

// ---- members ---------------------------------------------------------------------------------

void LockstepRounds::add(MemberId id, const std::string& name, std::int32_t rank,
                         Nanoseconds wall) {
  MemberState& member = members_.add(id, name, rank);
  const auto& declared = settings_.idle_nodes;
  member.waits_for_work = std::find(declared.begin(), declared.end(), name) != declared.end();
  last_join_ = wall;
  if (started_) {
    members_.makeReady(id, member);  // its first grant
  }
}

void LockstepRounds::remove(MemberId id) {
  mail_.forget(members_.at(id));
  members_.remove(id);
}

void LockstepRounds::knock(MemberId id) {
  MemberState& member = members_.at(id);
  member.knocked = true;
  if (started_) {
    members_.makeReady(id, member);
  }
}

void LockstepRounds::report(MemberId id, Nanoseconds next, std::uint32_t open, Nanoseconds wall,
                            Nanoseconds played) {
  MemberState& member = members_.at(id);
  if (std::exchange(member.silence_told, false)) {
    events_.push_back({Event::Kind::kAnswered, id, wall - member.granted_wall});
  }
  members_.settle(member);
  member.open = open;
  member.idle = 0;
  member.background = false;
  member.keep_until = kNever;
  // Nothing can be due after the end of simulated time.
  member.after_played = next > kLastInstant ? kNever : next;
  members_.playNext(id, played);
  member.happened = member.played == kNever ? std::nullopt : std::make_optional(clock_.time);
  if (next <= (windows_.areThere() ? member.latest : clock_.time)) {
    members_.makeReady(id, member);
  }
}

// ---- decisions -------------------------------------------------------------------------------

bool LockstepRounds::settled() const { return members_.owing() == 0; }

std::vector<LockstepRounds::Grant> LockstepRounds::decide(Nanoseconds wall) {
  if (ended()) {
    return {};
  }
  if (is_finishing_) {
    std::vector<Grant> grants = lastRound(wall);
    if (grants.empty()) {
      end();
    }
    return grants;
  }
  if (zero_delay_loop_) {
    return {};
  }
  gate_.forgetLimit();
  if (!started_) {
    return mayStart(wall) ? start(wall) : std::vector<Grant>{};
  }
  if (windows_.areThere()) {
    return nextWindow(wall);
  }
  mail_.keepPosted();
  if (members_.ready().empty()) {
    members_.wakeResting();
  }
  return members_.ready().empty() ? leap(wall) : nextMicrostep(wall);
}

bool LockstepRounds::mayStart(Nanoseconds wall) const {
  if (members_.all().empty()) {
    return false;
  }
  if (!settings_.participants.empty()) {
    return missing().empty();
  }
  return wall >= addSaturated(last_join_, toNanoseconds(settings_.settle));
}

std::vector<LockstepRounds::Grant> LockstepRounds::start(Nanoseconds wall) {
  started_ = true;
  gate_.leapt(wall);
  events_.push_back({Event::Kind::kStarted});
  std::vector<MemberId> ids = members_.begin(clock_.time);
  if (windows_.areThere()) {
    return grantWindow(clock_.time, wall);
  }
  return ids.empty() ? leap(wall) : grant(std::move(ids), wall);
}

std::vector<LockstepRounds::Grant> LockstepRounds::nextMicrostep(Nanoseconds wall) {
  std::vector<MemberId> ids;
  for (const MemberId id : members_.ready()) {
    const MemberState* const found = members_.find(id);
    if (found != nullptr && found->ready) {
      ids.push_back(id);
    }
  }
  if (ids.empty()) {
    members_.dropGranted();
    return leap(wall);
  }
  if (isLoop()) {
    return {};
  }
  ++clock_.microstep;
  return grant(std::move(ids), wall);
}

/**
 * @brief Check before one more round at the present instant. @return whether there were too many.
 */
bool LockstepRounds::isLoop() {
  if (clock_.microstep >= settings_.max_microsteps) {
    zero_delay_loop_ = true;
    events_.push_back({Event::Kind::kZeroDelayLoop});
  }
  return zero_delay_loop_;
}

std::vector<LockstepRounds::Grant> LockstepRounds::leap(Nanoseconds wall) {
  std::vector<MemberId> ids;
  while (ids.empty()) {  // mail that arrives may need no grant
    if (!goTo(nextTime(), wall)) {
      return {};
    }
    if (outside_.next() <= clock_.time) {
      ids = arrive();
    }
    for (const auto& [due, id] : members_.due()) {
      if (due > clock_.time) {
        break;
      }
      ids.push_back(id);
    }
  }
  return grant(std::move(ids), wall);
}

/** @return whether time has come to @p next. If not, it may not go on so far as yet. */
bool LockstepRounds::goTo(Nanoseconds next, Nanoseconds wall) {
  if (gate_.holdsForOthers()) {
    return false;  // even a run without anything left to do is not idle yet
  }
  if (next == kNever) {
    becomeIdle();
    if (settings_.end_when_idle) {
      return false;  // the run ends here, not at a later `end_at`
    }
  }
  const Nanoseconds to = gate_.stopBefore(next);
  if (!gate_.mayGo(clock_.time, to, wall)) {
    return false;
  }
  if (clock_.moveTo(to)) {
    gate_.leapt(wall);
  }
  if (to < next) {
    gate_.reach();
    events_.push_back({Event::Kind::kTargetReached});
  }
  return to == next;
}

/**
 * @brief Let mail under way arrive, in a round of its own without grants. So kept mail stays in the
 * order of its arrival.
 * @return the members to grant for this mail, except those that are due anyway.
 */
std::vector<MemberId> LockstepRounds::arrive() {
  ++clock_.rounds;
  ++clock_.played;
  outside_.arrive();
  mail_.keepPosted();
  std::vector<MemberId> ids;
  for (const MemberId id : members_.ready()) {
    const MemberState* const member = members_.find(id);
    if (member != nullptr && member->ready && member->next > clock_.time) {
      ids.push_back(id);
    }
  }
  return ids;
}

/**
 * @brief Open the next window, with a lookahead. Call this when no member can do anything before it
 * any more, and all earlier actions are applied.
 */
std::vector<LockstepRounds::Grant> LockstepRounds::nextWindow(Nanoseconds wall) {
  for (Nanoseconds due = outside_.next(); due < windows_.begin(); due = outside_.next()) {
    if (!goTo(due, wall)) {
      return {};
    }
    windows_.arriveUntil(due);  // the window may begin sooner then
  }
  const Nanoseconds begin = windows_.begin();
  if (begin == clock_.time) {
    if (isLoop()) {
      return {};
    }
    ++clock_.microstep;
    return grantWindow(begin, wall);
  }
  const bool stays = !gate_.target() || settings_.end_when_idle;
  if (begin == kNever && stays && !gate_.paused()) {  // time stands at the last turn
    windows_.standAt(windows_.latest());
  }
  return goTo(begin, wall) ? grantWindow(begin, wall) : std::vector<Grant>{};
}

std::vector<LockstepRounds::Grant> LockstepRounds::grantWindow(Nanoseconds begin,
                                                               Nanoseconds wall) {
  idle_ = false;
  std::vector<MemberId> ids = windows_.open(begin, gate_);
  std::vector<Grant> grants;
  for (const auto& [id, until] : windows_.played()) {
    grants.push_back({id, clock_.rounds, until, 0, {}, true, {}, {}});
  }
  return enterWindow(std::move(ids), wall, std::move(grants));
}

std::vector<LockstepRounds::Grant> LockstepRounds::enterWindow(std::vector<MemberId> ids,
                                                               Nanoseconds wall,
                                                               std::vector<Grant> grants) {
  clock_.rounds += ids.empty() ? 0 : 1;
  for (const MemberId id : ids) {
    MemberState& member = members_.at(id);
    const Nanoseconds next = windows_.ownNextOf(member);
    if (member.happened) {
      member.happened = std::max(next - 1, member.latest);
    }
    grants.push_back(grantOne(id, member, wall));
    grants.back().time = next;
    grants.back().later += windows_.enter(member, next);
  }
  watch_.begin(wall) = std::move(ids);
  return grants;
}

std::vector<LockstepRounds::Grant> LockstepRounds::grant(std::vector<MemberId> ids,
                                                         Nanoseconds wall) {
  members_.sort(ids);
  ++clock_.rounds;
  idle_ = false;
  std::vector<Grant> grants;
  grants.reserve(ids.size());
  std::vector<MemberId>& granted = watch_.begin(wall);
  for (const MemberId id : ids) {
    MemberState& member = members_.at(id);
    if (!member.ready && !member.owes && member.played <= clock_.time) {
      member.happened = clock_.time;
      grants.push_back({id, clock_.rounds, clock_.time, clock_.microstep, {}, true, {}, {}});
    } else {
      grants.push_back(grantOne(id, member, wall));
      granted.push_back(id);
    }
  }
  clock_.played += granted.empty() ? 1 : 0;
  members_.dropGranted();
  return grants;
}

/** @return the grants with all that was sent to members and that they have not got yet. */
std::vector<LockstepRounds::Grant> LockstepRounds::lastRound(Nanoseconds wall) {
  if (windows_.areThere()) {
    return enterWindow(windows_.openLast(), wall);
  }
  std::vector<MemberId> ids;
  for (const auto& [id, member] : members_.all()) {
    members_.at(id).ready = member.present && (hasNews(member.mail) || !member.later.empty());
    if (member.ready) {
      ids.push_back(id);
    }
  }
  if (ids.empty()) {
    return {};
  }
  ++clock_.microstep;
  return grant(std::move(ids), wall);
}

LockstepRounds::Grant LockstepRounds::grantOne(MemberId id, MemberState& member, Nanoseconds wall) {
  member.granted_due = member.next <= clock_.time;
  member.granted_mail = static_cast<std::uint32_t>(member.mail.size() + member.later.size());
  member.granted_wall = wall;
  member.round = clock_.rounds;
  member.ready = false;
  member.resting = false;
  member.knocked = false;
  members_.expectReport(member);
  members_.setNext(id, member, kNever);
  member.played = member.after_played = kNever;  // this grant may change all later turns
  std::vector<Mail> mail = mail_.take(id, member);
  return {id,
          clock_.rounds,
          clock_.time,
          clock_.microstep,
          std::move(mail),
          false,
          std::exchange(member.happened, std::nullopt),
          mail_.takeLater(member)};
}

void LockstepRounds::becomeIdle() {
  if (idle_) {
    return;
  }
  idle_ = true;
  events_.push_back({members_.areStuck(owed_ > 0) ? Event::Kind::kDeadlock : Event::Kind::kIdle});
}

void LockstepRounds::watch(Nanoseconds wall) {
  for (const MemberId id : watch_.look(wall)) {
    events_.push_back({Event::Kind::kSilent, id, wall - members_.at(id).granted_wall});
  }
}

std::vector<LockstepRounds::Event> LockstepRounds::takeEvents() {
  std::vector<Event> events;
  events.swap(events_);
  return events;
}

}  // namespace move_base_abstract
