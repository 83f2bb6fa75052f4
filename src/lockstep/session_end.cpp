// How a run ends: by itself, by whoever is told to end, or by the time master.
#include <algorithm>

#include "clock/number_text.h"
#include "session.h"

namespace move_base_abstract {

void LockstepSession::endAsWished(const std::string& reason) {
  ended_as_wished_ = ended_as_wished_ || !rounds_.ended();
  end(reason);
}

void LockstepSession::end(const std::string& reason) {
  if (rounds_.ended()) {
    return;
  }
  rounds_.end();
  reason_ = reason;
  interruption_.finish();  // time has stood since then: it matters to nobody who went first
  connections_.closeAll(reason, ended_as_wished_);
  messages_.say(Level::kInfo, "the run ended" + text_.at() + " after " +
                                  std::to_string(rounds_.rounds() - rounds_.playedRounds()) +
                                  " rounds with " + std::to_string(router_.messages()) +
                                  " messages: " + reason);
}

void LockstepSession::endFromOutside(const std::string& reason) {
  if (!rounds_.ended()) {
    cut_ = cut_ || !(interruption_.isActive() ? rested_ : rounds_.atRest());
    end(reason);
  }
}

void LockstepSession::loseRosMaster(const std::string& how) {
  if (rounds_.started() && !rounds_.ended()) {
    labels_.addNotRepeatable("the ROS master was lost" + text_.at() +
                             ": what it could not be asked any more, and where the run ended, is "
                             "the wall clock's");
  }
  labels_.addDegraded(how + ", found" + text_.at());
  endFromOutside(how);
}

/** @brief Where the settings are strict, the first label ends the run. */
void LockstepSession::endIfLabelled() {
  if (is_strict_ && !rounds_.ended() && !labels_.first().empty()) {
    end("strict, and the run is " + labels_.first() + " (noticed" + text_.at() + ")");
  }
}

// ---- participants that are told to end -------------------------------------------------------

void LockstepSession::takeStopping(MemberId id, const wire::Stopping& stopping) {
  if (!rounds_.started() || interruption_.concerns(id)) {
    return;
  }
  messages_.say(Level::kInfo, text_.quoted(id) + " is told to end (" +
                                  std::string(stopping.reason) + ")" + text_.at() +
                                  ": time stands until it is clear whether others go on");
  beginInterruption(id);
}

void LockstepSession::beginInterruption(MemberId id) {
  if (!interruption_.isActive()) {
    rested_ = rounds_.atRest();
  }
  interruption_.begin(id, members_.at(id).connection, wall_);
}

void LockstepSession::takeLeave(MemberId id, const wire::Leave& leave) {
  if (rounds_.started()) {
    beginInterruption(id);
    keepLeft(id);
  }
  depart(id, "left" + (leave.reason.empty() ? "" : " (" + std::string(leave.reason) + ")"));
}

void LockstepSession::keepLeft(MemberId id) {
  interruption_.keep({Interruption::Label::Kind::kLeft, id,
                      text_.quoted(id) + " left" + text_.at() + ", when the wall clock said so"});
}

/** @return whether time stands because participants are told to end. */
bool LockstepSession::heldByInterruption() {
  if (!interruption_.isActive()) {
    return false;
  }
  const bool anybody_stays =
      std::any_of(members_.begin(), members_.end(), [this](const auto& entry) {
        return !entry.second.departing && !interruption_.concerns(entry.first);
      });
  if (!anybody_stays) {
    endTogether();
    return false;
  }
  if (wall_ < interruption_.due()) {
    return true;
  }
  goOnWithoutSome();
  return false;
}

/** @brief All go: what they did in the round that is not over counts for none, whoever was first.
 */
void LockstepSession::endTogether() {
  for (auto& [id, member] : members_) {
    if (!member.departing) {
      connections_.close(member.connection, "all who take part were told to end");
      depart(id, "was told to end");
    }
    member.turn = PendingTurn();
    member.foreseen.clear();
    member.walked.clear();
  }
  sets_.clear();
  interruption_.finish();
  cut_ = cut_ || !rested_;
  ends_together_ = true;
}

void LockstepSession::goOnWithoutSome() {
  using Kind = Interruption::Label::Kind;
  for (const Interruption::Label& label : interruption_.finish()) {
    if (label.kind == Kind::kDied) {
      degrade(label.text);
    } else if (label.kind == Kind::kInput || goesOnWithout(label.member)) {
      labels_.addNotRepeatable(label.text);
    }
  }
}

/** @return whether others have something to do yet, so that it matters when this one leaves. */
bool LockstepSession::goesOnWithout(MemberId id) const {
  return std::any_of(rounds_.members().begin(), rounds_.members().end(), [id](const auto& entry) {
    return entry.first != id && entry.second.present &&
           (entry.second.owes || entry.second.next != kNever || !entry.second.arrivals.empty());
  });
}

void LockstepSession::degrade(const std::string& why) {
  labels_.addDegraded(why);
  if (settings_.on_death == OnDeath::kEnd && death_.empty()) {
    death_ = why;
  }
}

/** @return why nothing happens any more: of a deadlock, a zero-delay loop, the end. */
std::string LockstepSession::reason() const {
  return rounds_.ended() ? reason_ : text_.standstill(phase(), router_.goals());
}

}  // namespace move_base_abstract
