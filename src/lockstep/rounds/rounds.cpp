#include "rounds.h"

#include <algorithm>

#include "clock/time_master.h"

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kLastInstant = TimeMaster::kLastInstant;

}  // namespace

LockstepRounds::LockstepRounds(const LockstepSettings& settings)
    : settings_(checkedSettings(settings)),
      lookahead_(toNanoseconds(settings.lookahead)),
      time_(std::max<Nanoseconds>(1, toNanoseconds(settings.start_time))),
      paused_(settings.start_paused),
      limit_(checkedLimit(settings.limit)) {}

// ---- members ---------------------------------------------------------------------------------

void LockstepRounds::add(MemberId id, const std::string& name, std::int32_t rank,
                         Nanoseconds wall) {
  MemberState& member = members_[id];
  member.name = name;
  member.rank = rank;
  const auto& declared = settings_.idle_nodes;
  member.waits_for_work = std::find(declared.begin(), declared.end(), name) != declared.end();
  places_.add(id, name);
  last_join_ = wall;
  if (started_) {
    makeReady(id, member);  // its first grant
  }
}

void LockstepRounds::gone(MemberId id) {
  MemberState& member = at(id);
  if (!member.present) {
    return;
  }
  member.present = false;
  setNext(id, member, kNever);
  member.foreseen.clear();
  member.open = member.idle = 0;
  if (member.owes) {
    member.owes = false;
    --owing_;
  }
}

void LockstepRounds::remove(MemberId id) {
  gone(id);
  mail_waiting_ -= at(id).mail.size();
  members_.erase(id);
  places_.remove(id);
}

void LockstepRounds::knock(MemberId id) {
  MemberState& member = at(id);
  member.knocked = true;
  if (started_) {
    makeReady(id, member);
  }
}

void LockstepRounds::report(MemberId id, Nanoseconds next, std::uint32_t open, Nanoseconds wall,
                            std::deque<Nanoseconds> foreseen) {
  MemberState& member = at(id);
  if (member.silence_told) {
    member.silence_told = false;
    events_.push_back({Event::Kind::kAnswered, id, wall - member.granted_wall});
  }
  member.owes = false;
  --owing_;
  member.open = open;
  member.idle = 0;
  member.background = false;
  member.keep_until = kNever;
  // Beyond the end of simulated time nothing can be due.
  member.after_foreseen = next > kLastInstant ? kNever : next;
  member.happened = foreseen.empty() ? std::nullopt : std::optional<std::uint32_t>(0);
  member.foreseen = std::move(foreseen);
  setNext(id, member, member.foreseen.empty() ? member.after_foreseen : member.foreseen.front());
  if (next <= (hasWindows() ? member.latest : time_)) {
    makeReady(id, member);
  }
}

LockstepRounds::MemberState& LockstepRounds::at(MemberId id) { return members_.at(id); }

const LockstepRounds::MemberState* LockstepRounds::find(MemberId id) const {
  const auto found = members_.find(id);
  return found == members_.end() ? nullptr : &found->second;
}

void LockstepRounds::makeReady(MemberId id, MemberState& member) {
  if (!member.ready) {
    member.ready = true;
    ready_.push_back(id);
  }
}

void LockstepRounds::rest(MemberId id) {
  MemberState& member = at(id);
  if (!member.resting) {
    member.resting = true;
    resting_.push_back(id);
  }
}

void LockstepRounds::setNext(MemberId id, MemberState& member, Nanoseconds next) {
  if (member.next != kNever) {
    due_.erase({member.next, id});
  }
  member.next = next;
  if (next != kNever) {
    due_.insert({next, id});
  }
}

// ---- decisions -------------------------------------------------------------------------------

bool LockstepRounds::settled() const { return owing_ == 0; }

std::vector<LockstepRounds::Grant> LockstepRounds::decide(Nanoseconds wall) {
  if (ended_ || zero_delay_loop_) {
    return {};
  }
  held_by_limit_ = false;
  if (!started_) {
    return mayStart(wall) ? start(wall) : std::vector<Grant>{};
  }
  if (hasWindows()) {
    return nextWindow(wall);
  }
  keepPosted();
  if (ready_.empty()) {
    wakeResting();
  }
  return ready_.empty() ? leap(wall) : nextMicrostep(wall);
}

bool LockstepRounds::mayStart(Nanoseconds wall) const {
  if (members_.empty()) {
    return false;
  }
  if (!settings_.participants.empty()) {
    return missing().empty();
  }
  return wall >= addSaturated(last_join_, toNanoseconds(settings_.settle));
}

std::vector<LockstepRounds::Grant> LockstepRounds::start(Nanoseconds wall) {
  started_ = true;
  last_leap_ = wall;
  events_.push_back({Event::Kind::kStarted});
  std::vector<MemberId> ids;
  for (auto& [id, member] : members_) {
    ids.push_back(id);
    member.ready = true;
  }
  return hasWindows() ? grantWindow(time_, wall) : grant(std::move(ids), wall);
}

std::vector<LockstepRounds::Grant> LockstepRounds::nextMicrostep(Nanoseconds wall) {
  std::vector<MemberId> ids;
  for (const MemberId id : ready_) {
    const auto found = members_.find(id);
    if (found != members_.end() && found->second.ready) {
      ids.push_back(id);
    }
  }
  if (ids.empty()) {
    ready_.clear();
    return leap(wall);
  }
  if (isLoop()) {
    return {};
  }
  ++microstep_;
  return grant(std::move(ids), wall);
}

/** @brief Before one more round at the present instant. @return whether there were too many. */
bool LockstepRounds::isLoop() {
  if (microstep_ >= settings_.max_microsteps) {
    zero_delay_loop_ = true;
    events_.push_back({Event::Kind::kZeroDelayLoop});
  }
  return zero_delay_loop_;
}

std::vector<LockstepRounds::Grant> LockstepRounds::leap(Nanoseconds wall) {
  std::vector<MemberId> ids;
  while (ids.empty()) {  // what arrives may be for nobody, or be only put by
    if (!goTo(nextTime(), wall)) {
      return {};
    }
    if (nextArrival() <= time_) {
      ids = arrive();
    }
    for (auto due = due_.begin(); due != due_.end() && due->first <= time_; ++due) {
      ids.push_back(due->second);
    }
  }
  return grant(std::move(ids), wall);
}

/** @return whether time has come to @p next; else it may not go on so far as yet. */
bool LockstepRounds::goTo(Nanoseconds next, Nanoseconds wall) {
  if (next == kNever) {
    becomeIdle();
    if (settings_.end_when_idle) {
      return false;  // the run ends here, not at a later end that it has, too
    }
  }
  if (paused_) {
    return false;
  }
  const bool to_target = target_ && next > *target_;
  const Nanoseconds to = to_target ? *target_ : next;
  if (to == kNever) {
    return false;
  }
  held_by_limit_ = wall < leapWall(to);
  if (held_by_limit_) {
    return false;
  }
  moveTo(to, wall);
  if (to_target) {
    paused_ = true;
    target_reached_ = true;
    target_.reset();
    events_.push_back({Event::Kind::kTargetReached});
  }
  return !to_target;
}

void LockstepRounds::moveTo(Nanoseconds to, Nanoseconds wall) {
  if (to == time_) {
    return;
  }
  time_ = to;
  microstep_ = 0;
  last_leap_ = wall;
  ++leaps_;
}

Nanoseconds LockstepRounds::leapWall(Nanoseconds to) const {
  if (limit_ == 0 || to <= time_) {
    return last_leap_;
  }
  __extension__ using Wide = __int128;
  const Wide distance = static_cast<Wide>(to - time_) * kFactorUnit;
  const Wide wall = last_leap_ + (distance + limit_ - 1) / limit_;
  return wall > kNever ? kNever : static_cast<Nanoseconds>(wall);
}

std::vector<LockstepRounds::Grant> LockstepRounds::grant(std::vector<MemberId> ids,
                                                         Nanoseconds wall) {
  std::sort(ids.begin(), ids.end(), [this](MemberId a, MemberId b) { return before(a, b); });
  ++rounds_;
  idle_ = false;
  std::vector<Grant> grants;
  grants.reserve(ids.size());
  granted_.clear();
  for (const MemberId id : ids) {
    MemberState& member = at(id);
    if (isForeseen(member)) {
      takeForeseen(id, member);
      grants.push_back({id, rounds_, time_, microstep_, {}, true, {}, {}});
    } else {
      grants.push_back(grantOne(id, member, wall));
      granted_.push_back(id);
    }
  }
  played_ += granted_.empty() ? 1 : 0;
  ready_.erase(std::remove_if(ready_.begin(), ready_.end(),
                              [this](MemberId id) {
                                const MemberState* member = find(id);
                                return !member || !member->ready;
                              }),
               ready_.end());
  const Nanoseconds limit = toNanoseconds(settings_.silence_limit);
  silence_check_ = limit == 0 ? kNever : addSaturated(wall, limit);
  return grants;
}

LockstepRounds::Grant LockstepRounds::grantOne(MemberId id, MemberState& member, Nanoseconds wall) {
  member.granted_due = member.next <= time_;
  member.granted_mail = static_cast<std::uint32_t>(member.mail.size() + member.later.size());
  member.granted_wall = wall;
  member.round = rounds_;
  member.ready = false;
  member.resting = false;
  member.knocked = false;
  ++owing_;
  member.owes = true;
  setNext(id, member, kNever);
  member.foreseen.clear();  // what comes now may change all that was to come
  mail_waiting_ -= member.mail.size();
  std::vector<Mail> mail;
  mail.swap(member.mail);
  if (arrange_) {
    arrange_(id, mail);
  } else {
    std::stable_sort(mail.begin(), mail.end(),
                     [this](const Mail& a, const Mail& b) { return before(a.order, b.order); });
  }
  return {id,
          rounds_,
          time_,
          microstep_,
          std::move(mail),
          false,
          std::exchange(member.happened, std::nullopt),
          takeLater(member)};
}

void LockstepRounds::becomeIdle() {
  if (idle_) {
    return;
  }
  idle_ = true;
  events_.push_back({isStuck() ? Event::Kind::kDeadlock : Event::Kind::kIdle});
}

/** @brief Who waits for work is stuck only while an answer is owed, which it may be the one to
 * give. */
bool LockstepRounds::isStuck() const {
  const bool is_owed = owed_ > 0;
  return std::any_of(members_.begin(), members_.end(), [is_owed](const auto& entry) {
    const MemberState& member = entry.second;
    return (member.open > 0 && !member.waits_for_work) ||
           (member.open + member.idle > 0 && is_owed);
  });
}

void LockstepRounds::watch(Nanoseconds wall) {
  if (wall < silence_check_ || owing_ == 0) {
    return;
  }
  silence_check_ = kNever;  // once per silence
  for (const MemberId id : granted_) {
    const auto found = members_.find(id);
    if (found == members_.end() || !found->second.owes) {
      continue;
    }
    found->second.silence_told = true;
    events_.push_back({Event::Kind::kSilent, id, wall - found->second.granted_wall});
  }
}

std::vector<LockstepRounds::Event> LockstepRounds::takeEvents() {
  std::vector<Event> events;
  events.swap(events_);
  return events;
}

Nanoseconds LockstepRounds::nextWake() const {
  if (ended_ || zero_delay_loop_) {
    return kNever;
  }
  if (!started_) {
    const bool settling = settings_.participants.empty() && !members_.empty();
    return settling ? addSaturated(last_join_, toNanoseconds(settings_.settle)) : kNever;
  }
  if (owing_ > 0) {
    return silence_check_;
  }
  if (!held_by_limit_) {
    return kNever;
  }
  const Nanoseconds next = nextTime();
  return leapWall(target_ ? std::min(*target_, next) : next);
}

}  // namespace move_base_abstract
