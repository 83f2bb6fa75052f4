#include "rounds.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include "clock/number_text.h"
#include "clock/time_master.h"

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kLongReport = kNanosecondsPerSecond;  // wall; longer is shown as waiting
constexpr Nanoseconds kLastInstant = TimeMaster::kLastInstant;

[[noreturn]] void refuse(const std::string& text) { throw std::invalid_argument(text); }

/** @brief Refuse a value outside [low, high]; written so that NaN is refused too. */
double checked(const char* name, double value, double low, double high, const char* unit) {
  if (!(value >= low && value <= high)) {
    refuse(std::string(name) + " must be from " + numberText(low) + " to " + numberText(high) +
           unit + ", got " + numberText(value));
  }
  return value;
}

Nanoseconds toNanoseconds(double value) {
  return std::llround(value * static_cast<double>(kNanosecondsPerSecond));
}

/** @return the limit in billionths; 0: none. */
FactorUnits checkedLimit(double factor) {
  if (factor == 0.0) {
    return 0;
  }
  return std::llround(checked("limit", factor, TimeMaster::kSmallestFactor,
                              TimeMaster::kLargestFactor,
                              " simulated seconds per wall second (or 0 for none)") *
                      static_cast<double>(kFactorUnit));
}

LockstepSettings checkedSettings(LockstepSettings settings) {
  checked("start_time", settings.start_time, 1e-6, 2e9, " s");
  checked("settle", settings.settle, 0.0, 3600.0, " s of wall time");
  if (settings.silence_limit != 0.0) {
    checked("silence_limit", settings.silence_limit, 0.001, 86400.0,
            " s of wall time (or 0 for any)");
  }
  if (settings.max_microsteps < 1) {
    refuse("max_microsteps must be at least 1, got 0");
  }
  std::set<std::string> names;
  for (const std::string& name : settings.participants) {
    if (name.empty() || !names.insert(name).second) {
      refuse("participants must be names that differ, got '" + name + "'" +
             (name.empty() ? "" : " twice"));
    }
  }
  return settings;
}

bool isDigit(char c) { return c >= '0' && c <= '9'; }

/** @return the run of digits from @p at on without its leading zeros; @p at goes past it. */
std::string_view takeNumber(std::string_view text, std::size_t& at) {
  while (at < text.size() && text[at] == '0') {
    ++at;
  }
  const std::size_t begin = at;
  while (at < text.size() && isDigit(text[at])) {
    ++at;
  }
  return text.substr(begin, at - begin);
}

/** @return less than, equal to or more than 0 as @p a is before, level with or after @p b. */
int compareNaturally(std::string_view a, std::string_view b) {
  std::size_t i = 0;
  std::size_t k = 0;
  while (i < a.size() && k < b.size()) {
    if (isDigit(a[i]) && isDigit(b[k])) {
      const std::string_view left = takeNumber(a, i);
      const std::string_view right = takeNumber(b, k);
      if (left.size() != right.size()) {
        return left.size() < right.size() ? -1 : 1;
      }
      if (const int order = left.compare(right); order != 0) {
        return order;
      }
    } else if (a[i] != b[k]) {
      return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[k]) ? -1 : 1;
    } else {
      ++i;
      ++k;
    }
  }
  if (i < a.size() || k < b.size()) {
    return i < a.size() ? 1 : -1;
  }
  return 0;
}

}  // namespace

bool naturalLess(std::string_view a, std::string_view b) {
  const int order = compareNaturally(a, b);
  return order != 0 ? order < 0 : a < b;  // "a01" and "a1" are level, but not one name
}

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

LockstepRounds::LockstepRounds(const LockstepSettings& settings, const LockstepRules& rules)
    : settings_(checkedSettings(settings)),
      rules_(rules),
      time_(std::max<Nanoseconds>(1, toNanoseconds(settings.start_time))),
      paused_(settings.start_paused),
      limit_(checkedLimit(settings.limit)) {}

// ---- members ---------------------------------------------------------------------------------

void LockstepRounds::add(MemberId id, const std::string& name, std::int32_t rank,
                         Nanoseconds wall) {
  MemberState& member = members_[id];
  member.name = name;
  member.rank = rank;
  names_changed_ = true;
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
  member.open = 0;
  if (member.owes && rules_.dead_not_awaited) {
    member.owes = false;
    --owing_;
  }
}

void LockstepRounds::remove(MemberId id) {
  gone(id);
  mail_waiting_ -= at(id).mail.size();
  members_.erase(id);
  places_.erase(id);
}

void LockstepRounds::knock(MemberId id) {
  MemberState& member = at(id);
  member.knocked = true;
  if (started_ && rules_.knock_counts) {
    makeReady(id, member);
  }
}

void LockstepRounds::report(MemberId id, Nanoseconds next, std::uint32_t open, Nanoseconds wall) {
  MemberState& member = at(id);
  if (member.silence_told) {
    member.silence_told = false;
    events_.push_back({Event::Kind::kAnswered, id, wall - member.granted_wall});
  }
  member.owes = false;
  --owing_;
  member.open = open;
  // Beyond the end of simulated time nothing can be due.
  setNext(id, member, next > kLastInstant ? kNever : next);
  if (next <= time_ && rules_.time_never_back) {
    makeReady(id, member);
  }
}

void LockstepRounds::post(MemberId id, Mail mail) {
  const auto found = members_.find(id);
  if (found == members_.end() || !found->second.present) {
    return;
  }
  MemberState& member = found->second;
  if (!mail.waits) {
    makeReady(id, member);
  }
  member.mail.push_back(mail);
  ++mail_waiting_;
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

bool LockstepRounds::settled() const {
  if (!rules_.barrier) {
    return owing_ == 0 || owing_ < granted_.size();
  }
  return owing_ == 0;
}

std::vector<LockstepRounds::Grant> LockstepRounds::decide(Nanoseconds wall) {
  if (ended_ || zero_delay_loop_) {
    return {};
  }
  held_by_limit_ = false;
  if (!started_) {
    return mayStart(wall) ? start(wall) : std::vector<Grant>{};
  }
  const bool leap_first = !rules_.deliver_before_leap && !due_.empty();
  if (ready_.empty() || leap_first) {
    return leap(wall);
  }
  return nextMicrostep(wall);
}

void LockstepRounds::orderNames() const {
  if (!names_changed_) {
    return;
  }
  names_changed_ = false;
  std::vector<std::pair<std::string_view, MemberId>> names;
  for (const auto& [id, member] : members_) {
    names.emplace_back(member.name, id);
  }
  std::sort(names.begin(), names.end(), [this](const auto& a, const auto& b) {
    if (a.first != b.first) {
      return rules_.natural_order ? naturalLess(a.first, b.first) : a.first < b.first;
    }
    return a.second < b.second;
  });
  std::uint32_t place = 0;
  for (const auto& [name, id] : names) {
    places_[id] = place++;
  }
}

bool LockstepRounds::mayStart(Nanoseconds wall) const {
  if (members_.empty()) {
    return false;
  }
  if (!settings_.participants.empty()) {
    return !rules_.start_waits_for_named || missing().empty();
  }
  return wall >= addSaturated(last_join_, toNanoseconds(settings_.settle));
}

std::vector<LockstepRounds::Grant> LockstepRounds::start(Nanoseconds wall) {
  started_ = true;
  last_leap_ = wall;
  events_.push_back({Event::Kind::kStarted});
  std::vector<MemberId> ids;
  for (const auto& [id, member] : members_) {
    ids.push_back(id);
  }
  return grant(std::move(ids), wall);
}

std::vector<LockstepRounds::Grant> LockstepRounds::nextMicrostep(Nanoseconds wall) {
  std::vector<MemberId> ids;
  for (const MemberId id : ready_) {
    const auto found = members_.find(id);
    // A member may be busy only where the tests let others go on without it.
    if (found != members_.end() && found->second.ready && !found->second.owes) {
      ids.push_back(id);
    }
  }
  if (!rules_.grant_only_concerned) {
    ids.clear();
    for (const auto& [id, member] : members_) {
      ids.push_back(id);
    }
  }
  if (ids.empty()) {
    ready_.clear();
    return leap(wall);
  }
  if (rules_.microstep_bound && microstep_ >= settings_.max_microsteps) {
    zero_delay_loop_ = true;
    events_.push_back({Event::Kind::kZeroDelayLoop});
    return {};
  }
  microstep_ += rules_.later_than_sent ? 1 : 0;
  return grant(std::move(ids), wall);
}

Nanoseconds LockstepRounds::nextTime() const {
  if (due_.empty()) {
    return kNever;
  }
  if (rules_.leap_to_smallest || due_.size() == 1) {
    return due_.begin()->first;
  }
  return std::next(due_.begin())->first;
}

std::vector<LockstepRounds::Grant> LockstepRounds::leap(Nanoseconds wall) {
  const Nanoseconds next = nextTime();
  if (next == kNever) {
    becomeIdle();
  }
  if (paused_ && rules_.gate_pause) {
    return {};
  }
  const bool to_target = target_ && next > *target_ && rules_.gate_target;
  const Nanoseconds to = to_target ? *target_ : next;
  if (to == kNever) {
    return {};
  }
  held_by_limit_ = rules_.gate_limit && wall < leapWall(to);
  if (held_by_limit_) {
    return {};
  }
  moveTo(to, wall);
  if (to_target) {
    paused_ = true;
    target_.reset();
    events_.push_back({Event::Kind::kTargetReached});
    return {};
  }
  std::vector<MemberId> ids;
  for (auto due = due_.begin(); due != due_.end() && due->first <= to; ++due) {
    ids.push_back(due->second);
  }
  return grant(std::move(ids), wall);
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
  for (const MemberId id : ids) {
    MemberState& member = at(id);
    member.granted_due = member.next <= time_;
    member.granted_mail = static_cast<std::uint32_t>(member.mail.size());
    member.granted_wall = wall;
    member.round = rounds_;
    member.ready = false;
    member.knocked = false;
    owing_ += member.owes ? 0 : 1;
    member.owes = true;
    setNext(id, member, kNever);
    mail_waiting_ -= member.mail.size();
    std::vector<Mail> mail;
    mail.swap(member.mail);
    std::stable_sort(mail.begin(), mail.end(),
                     [this](const Mail& a, const Mail& b) { return before(a.order, b.order); });
    grants.push_back({id, rounds_, time_, microstep_, std::move(mail)});
  }
  granted_ = std::move(ids);
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

void LockstepRounds::becomeIdle() {
  if (idle_) {
    return;
  }
  idle_ = true;
  const bool stuck = rules_.deadlock_named && anyOpen();
  events_.push_back({stuck ? Event::Kind::kDeadlock : Event::Kind::kIdle});
}

bool LockstepRounds::anyOpen() const {
  return std::any_of(members_.begin(), members_.end(),
                     [](const auto& entry) { return entry.second.open > 0; });
}

void LockstepRounds::watch(Nanoseconds wall) {
  if (wall < silence_check_ || owing_ == 0) {
    return;
  }
  silence_check_ = kNever;  // once per silence
  for (const MemberId id : granted_) {
    const auto found = members_.find(id);
    if (found == members_.end() || !found->second.owes || !rules_.silence_named) {
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

// ---- gate ------------------------------------------------------------------------------------

void LockstepRounds::pause() {
  refuseIfEnded("pause");
  paused_ = true;
  target_.reset();
}

void LockstepRounds::resume() {
  refuseIfEnded("resume");
  paused_ = false;
  target_.reset();
}

Nanoseconds LockstepRounds::step(Nanoseconds duration) {
  refuseIfEnded("step");
  const Nanoseconds from = target_.value_or(time_);
  if (duration <= 0 || duration > kLastInstant - from) {
    refuse("step: duration must be more than 0 and at most " + secondsText(kLastInstant - from) +
           " from " + secondsText(from) + " on, got " + secondsText(duration));
  }
  paused_ = false;
  target_ = from + duration;
  return *target_;
}

void LockstepRounds::runUntil(Nanoseconds target) {
  refuseIfEnded("run_until");
  if (target < time_ || target > kLastInstant) {
    refuse("run_until: target must be from the present, " + secondsText(time_) + ", to " +
           secondsText(kLastInstant) + ", got " + secondsText(target));
  }
  paused_ = false;
  target_ = target;
}

void LockstepRounds::setLimit(double factor) {
  const FactorUnits limit = checkedLimit(factor);
  refuseIfEnded("limit");
  limit_ = limit;
}

void LockstepRounds::end() { ended_ = true; }

void LockstepRounds::refuseIfEnded(const char* call) const {
  if (ended_) {
    refuse(std::string(call) + ": the run has ended, at " + secondsText(time_));
  }
}

// ---- what is so ------------------------------------------------------------------------------

double LockstepRounds::limit() const {
  return static_cast<double>(limit_) / static_cast<double>(kFactorUnit);
}

LockstepPhase LockstepRounds::phase(Nanoseconds wall) const {
  if (ended_) {
    return LockstepPhase::kEnded;
  }
  if (!started_) {
    return LockstepPhase::kWaitingForParticipants;
  }
  if (zero_delay_loop_) {
    return LockstepPhase::kZeroDelayLoop;
  }
  if (owing_ > 0) {
    const bool working = std::none_of(granted_.begin(), granted_.end(), [this, wall](MemberId id) {
      const MemberState* member = find(id);
      return member && member->owes && wall - member->granted_wall > kLongReport;
    });
    return working ? LockstepPhase::kRunning : LockstepPhase::kWaiting;
  }
  if (idle_ && rules_.deadlock_named && anyOpen()) {
    return LockstepPhase::kDeadlock;
  }
  if (paused_) {
    return LockstepPhase::kPaused;
  }
  if (idle_) {
    return LockstepPhase::kIdle;
  }
  return held_by_limit_ ? LockstepPhase::kLimited : LockstepPhase::kRunning;
}

std::vector<MemberId> LockstepRounds::latestRound() const { return granted_; }

std::vector<std::string> LockstepRounds::missing() const {
  std::set<std::string_view> present;
  for (const auto& [id, member] : members_) {
    if (member.present) {
      present.insert(member.name);
    }
  }
  std::vector<std::string> missing;
  for (const std::string& name : settings_.participants) {
    if (present.count(name) == 0) {
      missing.push_back(name);
    }
  }
  return missing;
}

MailOrder LockstepRounds::order(MemberId id, std::uint32_t sub, std::uint64_t number) const {
  orderNames();
  const MemberState* member = find(id);
  const auto place = places_.find(id);
  return {member ? member->rank : 0, sub, place == places_.end() ? 0 : place->second, number};
}

bool LockstepRounds::before(MemberId a, MemberId b) const {
  const MailOrder left = order(a, 0, 0);
  const MailOrder right = order(b, 0, 0);
  return std::tie(left.rank, left.place, a) < std::tie(right.rank, right.place, b);
}

bool LockstepRounds::before(const MailOrder& a, const MailOrder& b) const {
  if (rules_.sort_by_rank && a.rank != b.rank) {
    return a.rank < b.rank;
  }
  if (rules_.sort_by_sub && a.sub != b.sub) {
    return a.sub < b.sub;
  }
  if (a.place != b.place) {
    return a.place < b.place;
  }
  return rules_.fifo_within_sender ? a.number < b.number : a.number > b.number;
}

}  // namespace move_base_abstract
