// How a run ends: by itself, because a participant leaves or dies, or because the time master ends
// it.
#include "run_end.h"

#include <algorithm>

#include "clock/number_text.h"

namespace move_base_abstract {
namespace {

/** @return the code of ended_by for a run that is ended now and stood in @p phase. */
std::string_view standstillCode(LockstepPhase phase) {
  return phase == LockstepPhase::kDeadlock        ? ended_by::kDeadlock
         : phase == LockstepPhase::kZeroDelayLoop ? ended_by::kZeroDelayLoop
                                                  : ended_by::kOther;
}

}  // namespace

void RunEnd::endAsWished(const std::string& reason, std::string_view code) {
  if (!isDecided()) {
    ended_as_wished_ = true;
    code_ = code;
  }
  end(reason);
}

void RunEnd::end(const std::string& reason) {
  if (isDecided()) {
    return;
  }
  note(reason);
  if (code_ == ended_by::kZeroDelayLoop) {
    close();  // what was sent last leads to more without end
    return;
  }
  run_.rounds.finish();
  for (auto& [id, member] : run_.members) {
    member.walked.clear();  // turns after the end
  }
}

void RunEnd::endAtOnce(const std::string& reason) {
  if (!run_.rounds.ended()) {
    note(reason);
    close();
  }
}

void RunEnd::note(const std::string& reason) {
  code_ = code_ == ended_by::kOther ? standstillCode(run_.rounds.phase(run_.wall)) : code_;
  reason_ = reason_.empty() ? reason : reason_;
}

void RunEnd::closeIfOver() {
  if (run_.rounds.isFinishing() && run_.rounds.ended() && !is_closed_) {
    run_.router.loseCarried();
    run_.log.closeRound();
    close();
  }
}

void RunEnd::close() {
  is_closed_ = true;
  run_.rounds.end();
  run_.interruption.finish();  // time has stood since it began, so its labels do not matter
  run_.connections.closeAll(reason_, ended_as_wished_);
  run_.messages.say(LockstepMessage::Level::kInfo,
                    "the run ended" + run_.text.at() + " after " +
                        std::to_string(run_.rounds.clock().rounds - run_.rounds.clock().played) +
                        " rounds with " + std::to_string(run_.router.messages()) +
                        " messages: " + reason_);
}

void RunEnd::endFromOutside(const std::string& reason) {
  if (!run_.rounds.ended()) {
    is_cut_ = is_cut_ ||
              !(run_.interruption.isActive() ? run_.interruption.rested() : run_.rounds.atRest());
    endAtOnce(reason);
  }
}

void RunEnd::loseRosMaster(const std::string& how) {
  if (run_.rounds.started() && !run_.rounds.ended()) {
    run_.labels.addNotRepeatable("the ROS master was lost" + run_.text.at() +
                                 ": the requests that it could still answer, and the instant of "
                                 "the run's end, depend on the wall clock");
  }
  run_.labels.addDegraded(how + ", found" + run_.text.at());
  endFromOutside(how);
}

void RunEnd::endIfLabelled() {
  // Which of several deaths at one instant is noticed first is chance: all of them are awaited.
  const bool is_sure = run_.rounds.settled() || !run_.labels.notRepeatable().empty();
  if (!run_.rounds.ended() && isLabelledStrictly() && is_sure) {
    endAtOnce("strict, and the run is " + run_.labels.first() + " (noticed" + run_.text.at() + ")");
  }
}

void RunEnd::endIfSomebodyHasGone() {
  if (!death_.empty()) {
    end(death_);
  } else if (!left_.empty()) {
    endAsWished(left_, ended_by::kDeparture);
  }
}

void RunEnd::degrade(const std::string& why) {
  run_.labels.addDegraded(why);
  if (run_.settings.on_death == OnDeath::kEnd && (death_.empty() || why < death_)) {
    death_ = why;  // of several at one instant, the same one in each run
  }
}

void RunEnd::noteDeparture(const SessionMember& member, const std::string& what) {
  const auto& last = run_.settings.end_with;
  if (run_.rounds.started() && std::find(last.begin(), last.end(), member.name) != last.end()) {
    std::string& why = member.dead ? death_ : left_;
    left_node_ = !member.dead && left_.empty() ? member.name : left_node_;
    why = why.empty() ? what + run_.text.at() + ", and the run ends with it" : why;
  }
  has_died_ = has_died_ || (member.dead && !death_.empty());
}

std::string RunEnd::reason() const {
  return isDecided() ? reason_
                     : run_.text.standstill(run_.rounds.phase(run_.wall), run_.router.goals());
}

bool RunEnd::isLabelledStrictly() const { return is_strict_ && !run_.labels.first().empty(); }

}  // namespace move_base_abstract
