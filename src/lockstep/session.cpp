#include "session.h"

#include <algorithm>
#include <utility>

#include "clock/number_text.h"
#include "clock/shown_text.h"

namespace move_base_abstract {
namespace {

constexpr std::size_t kKeptGrant = 4096;  // bytes, to say what a silent one was told last
constexpr Nanoseconds kMissingGap = 5 * kNanosecondsPerSecond;  // wall
constexpr std::size_t kMostDepartures = 1000;                   // that are kept

}  // namespace

LockstepSession::LockstepSession(const LockstepSettings& settings, Nanoseconds wall)
    : settings_(settings),
      rounds_(settings),
      log_(rounds_, settings.keeps_bytes),
      router_([this](MemberId id, Mail mail) { rounds_.post(id, mail); },
              [this](MemberId id, std::uint32_t sub, std::uint64_t number) {
                return rounds_.order(id, sub, number);
              },
              settings.log_messages ? MessageRouter::Trace([this](const auto& delivery) {
                log_.add(delivery, [this](MemberId id) { return text_.nameOf(id); });
              })
                                    : MessageRouter::Trace()),
      wall_(wall),
      began_(wall),
      missing_due_(settings.participants.empty() ? kNever : wall + kMissingGap),
      last_id_(static_cast<MemberId>(settings.participants.size())),
      text_(rounds_, members_),
      labels_(messages_),
      is_strict_(settings.strict) {
  keepEnd();
  router_.setStored(StoredTopics(settings_.stored_topics));
  for (const std::string& why : settings_.not_covered) {
    labels_.addNotRepeatable(why);
  }
}

// ---- the end of a round ----------------------------------------------------------------------

std::vector<LockstepSession::Output> LockstepSession::poll(Nanoseconds wall) {
  wall_ = std::max(wall_, wall);
  poll_due_ = false;
  if (!rounds_.ended()) {
    rounds_.watch(wall_);
    handleEvents();
    endIfLabelled();
    if (!heldByInterruption() && rounds_.settled()) {
      finishRound();
    }
    nameMissing();
    dropSilentStrangers();
  }
  return connections_.flush();
}

/** @brief ... and those after it of which all turns have been told beforehand. */
void LockstepSession::finishRound() {
  do {
    applyRound();
    endIfLabelled();
    if (!death_.empty()) {
      end(death_);
    } else if (!left_.empty()) {
      endAsWished(left_);
    }
    noteChanged();
    rounds_.setOwed(router_.goals().count() + router_.openCalls());
    sendGrants(rounds_.decide(wall_));
    sayGone();
    handleEvents();
    endIfLabelled();
  } while (!changed_.empty() && rounds_.settled());
}

void LockstepSession::applyRound() {
  if (rounds_.hasWindows()) {
    applyWindow();
    return;
  }
  if (changed_.empty()) {
    return;
  }
  std::vector<MemberId> ids;
  ids.swap(changed_);
  std::sort(ids.begin(), ids.end(), [this](auto a, auto b) { return rounds_.before(a, b); });
  for (const MemberId id : ids) {
    Member& member = members_.at(id);
    member.listed = false;
    if (member.turn.frame) {
      applyTurn(id, member);
    }
    if (member.departing) {
      applyDeparture(id);
    }
  }
  changed_.clear();  // who is dropped for its report has departed in its turn
  endOfTurns();
}

/** @brief All turns of a round, or of an instant of a window, are applied. */
void LockstepSession::endOfTurns() {
  router_.finishRound();
  if (std::exchange(ends_together_, false)) {
    log_.dropRound();
  }
  log_.closeRound();
  for (const std::string& warning : router_.takeWarnings()) {
    messages_.say(Level::kWarn, warning);
  }
}

void LockstepSession::applyTurn(MemberId id, Member& member) {
  PendingTurn pending = std::exchange(member.turn, PendingTurn());
  try {
    for (const wire::ReportItem& item : pending.items) {
      applyItem(id, member, item);
    }
  } catch (const MessageRouter::BadAction& error) {
    connections_.close(member.connection, error.what());
    die(id, std::string("it was dropped: ") + error.what());
    member.walked.clear();
  }
  applied_.push_back(std::move(pending));
}

void LockstepSession::applyItem(MemberId id, Member& member, const wire::ReportItem& item) {
  const std::uint64_t number = member.actions++;
  if (const auto* log = std::get_if<wire::Log>(&item)) {
    log_.add(rounds_.order(id, log->sub, number), *log);
  } else if (const auto* note = std::get_if<wire::Note>(&item)) {
    applyNote(member, *note);
  } else if (std::holds_alternative<wire::Rest>(item)) {
    rounds_.rest(id);
  } else if (std::holds_alternative<wire::Background>(item)) {
    rounds_.background(id);
  } else if (const auto* parameter = std::get_if<wire::Parameter>(&item)) {
    applyParameter(member, *parameter);
  } else if (const auto* asks = std::get_if<wire::Asks>(&item)) {
    labelIf(parameters_.asks(member.name, asks->name));
  } else if (const auto* idle = std::get_if<wire::Idle>(&item)) {
    rounds_.idle(id, idle->count);
  } else if (const auto* keep = std::get_if<wire::KeepUntil>(&item)) {
    rounds_.keepUntil(id, keep->time_ns);
  } else {
    if (std::holds_alternative<wire::Hears>(item)) {
      rounds_.hurry(id);
    }
    router_.apply(id, number, item);
  }
}

void LockstepSession::applyNote(Member& member, const wire::Note& note) {
  switch (note.what) {
    case wire::NoteKind::kWaitsFor:
      member.waits_for = shown(note.text);
      break;
    case wire::NoteKind::kTells:
      member.tells = shown(note.text);
      break;
    case wire::NoteKind::kNotRepeatable:
      labels_.addNotRepeatable(quote(member.name) + ": " + std::string(note.text));
      break;
    case wire::NoteKind::kDegraded:
      labels_.addDegraded(quote(member.name) + ": " + std::string(note.text));
      break;
    case wire::NoteKind::kStrict:
      is_strict_ = true;
      break;
    case wire::NoteKind::kReads:
    case wire::NoteKind::kWrites:
      if (const std::string why = files_.add(member.name, note); !why.empty()) {
        labels_.addNotRepeatable(why);
      }
      break;
  }
}

void LockstepSession::applyDeparture(MemberId id) {
  Member& member = members_.at(id);
  if (!member.dead) {
    messages_.say(Level::kInfo,
                  text_.quoted(id) + " " + member.how + (rounds_.started() ? text_.at() : ""));
  }
  if (rounds_.started() && !rounds_.ended() && !ends_together_ &&
      departures_.size() < kMostDepartures) {
    departures_.push_back({member.name, rounds_.now(), member.dead});
  }
  const auto& last = settings_.end_with;
  if (rounds_.started() && std::find(last.begin(), last.end(), member.name) != last.end()) {
    std::string& why = member.dead ? death_ : left_;
    why = why.empty()
              ? text_.quoted(id) + " " + member.how + text_.at() + ", and the run ends with it"
              : why;
  }
  router_.remove(id, member.actions);
  rounds_.remove(id);
  members_.erase(id);
  gone_.push_back(id);
}

void LockstepSession::sendGrants(const std::vector<LockstepRounds::Grant>& grants) {
  if (!grants.empty()) {
    granted_.clear();
  }
  for (const LockstepRounds::Grant& grant : grants) {
    const auto member = members_.find(grant.member);
    if (member == members_.end()) {
      continue;
    }
    if (grant.foreseen) {
      member->second.turn = std::move(member->second.foreseen.front());
      member->second.foreseen.pop_front();
      listChanged(grant.member);
    } else {
      sendGrant(grant, member->second);
    }
  }
  if (!rounds_.mailWaiting()) {
    applied_.clear();
  }
}

void LockstepSession::sendGrant(const LockstepRounds::Grant& grant, Member& member) {
  std::string items;
  if (grant.happened) {
    wire::append(items, wire::Happened{*grant.happened});
  }
  if (std::exchange(member.has_changed, false) && !rounds_.hasWindows()) {
    wire::append(items, wire::Changed{});
  }
  items += grant.later;
  for (const Mail& mail : grant.mail) {
    wire::append(items, mail.item);
  }
  granted_.push_back(grant.member);
  member.foreseen.clear();
  member.where.clear();
  member.silence_told = false;
  member.granted.assign(items, 0, items.size() <= kKeptGrant ? items.size() : 0);
  connections_.send(member.connection,
                    wire::encodeGrant({grant.round, grant.time, grant.microstep, {}}, items));
}

ConnectionId LockstepSession::lastAwaited() {
  while (!granted_.empty()) {
    const auto member = members_.find(granted_.back());
    const LockstepRounds::MemberState* const state = rounds_.find(granted_.back());
    if (member != members_.end() && state != nullptr && state->owes) {
      return member->second.connection;
    }
    granted_.pop_back();
  }
  return 0;
}

/** @brief Only now, since the grants before it may still contain the last words of those. */
void LockstepSession::sayGone() {
  for (const MemberId id : gone_) {
    const std::string news = wire::encode(wire::MasterFrame(wire::Gone{id}));
    for (const auto& [other, member] : members_) {
      connections_.send(member.connection, news);
    }
  }
  gone_.clear();
}

// ---- events ----------------------------------------------------------------------------------

void LockstepSession::handleEvents() {
  for (const LockstepRounds::Event& event : rounds_.takeEvents()) {
    handle(event);
  }
}

void LockstepSession::handle(const LockstepRounds::Event& event) {
  using Kind = LockstepRounds::Event::Kind;
  switch (event.kind) {
    case Kind::kStarted:
      missing_due_ = kNever;
      if (settings_.participants.empty()) {
        labels_.addNotRepeatable(
            "no participants are named: who takes part from the start on depends on the wall "
            "clock");
      }
      messages_.say(Level::kInfo, "the clock starts" + text_.at() + " with " +
                                      countText(members_.size(), "participant"));
      break;
    case Kind::kSilent:
    case Kind::kAnswered:
      handleSilence(event);
      break;
    case Kind::kTargetReached:
      messages_.say(Level::kDebug, "reached " + secondsText(rounds_.now()) + ", paused");
      if (settings_.end_at != 0.0 && rounds_.now() >= toNanoseconds(settings_.end_at)) {
        endAsWished("the run was to end" + text_.at());
      }
      break;
    case Kind::kIdle:
    case Kind::kDeadlock:
    case Kind::kZeroDelayLoop:
      handleStandstill(event);
      break;
  }
}

void LockstepSession::handleStandstill(const LockstepRounds::Event& event) {
  using Kind = LockstepRounds::Event::Kind;
  if (event.kind == Kind::kIdle) {
    messages_.say(Level::kDebug, text_.idle());
    if (settings_.end_when_idle) {
      endAsWished(text_.idle());
    }
    return;
  }
  messages_.say(event.kind == Kind::kDeadlock ? Level::kWarn : Level::kError, reason());
  if (settings_.end_when_idle && event.kind == Kind::kDeadlock) {
    end(reason());
  }
}

void LockstepSession::nameMissing() {
  if (rounds_.started() || wall_ < missing_due_) {
    return;
  }
  missing_due_ = wall_ + kMissingGap;
  messages_.say(Level::kInfo, "the clock does not start without " + text_.missing());
}

Nanoseconds LockstepSession::nextWake() const {
  if (poll_due_ || connections_.hasOutput()) {
    return wall_;
  }
  return rounds_.ended() ? kNever
                         : std::min({rounds_.nextWake(), missing_due_, connections_.helloDue(),
                                     interruption_.due()});
}

// ---- what is so ------------------------------------------------------------------------------

std::vector<LockstepLogEntry> LockstepSession::takeLog() { return log_.take(); }

std::vector<LockstepMessage> LockstepSession::takeMessages() { return messages_.take(); }

LockstepStatus LockstepSession::status() const {
  LockstepStatus status;
  status.phase = phase();
  status.time = rounds_.now();
  status.microstep = rounds_.microstep();
  status.paused = rounds_.paused();
  if (!rounds_.ended()) {
    status.waiting_for = text_.waitingFor(began_, interruption_, router_);
  }
  status.participants = text_.participants();
  status.not_repeatable = labels_.notRepeatable();
  status.degraded = labels_.degraded();
  status.departures = departures_;
  status.reason = reason();
  status.ended_as_wished = ended_as_wished_;
  status.cut = cut_;
  status.limit = rounds_.limit();
  status.run_until = rounds_.target();
  status.rounds = rounds_.rounds() - rounds_.playedRounds();
  status.leaps = rounds_.leaps();
  status.messages = router_.messages();
  return status;
}

}  // namespace move_base_abstract
