// Applies what participants do in their turns, in the stated order.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "departures.h"
#include "lockstep/wire/wire.h"
#include "run.h"
#include "run_end.h"
#include "shared_files.h"

namespace move_base_abstract {

class Turns {
 public:
  Turns(LockstepRun& run, RunEnd& end, Departures& departures)
      : run_(run), end_(end), departures_(departures) {}

  /** @brief Keep @p report until the round is over. Its items point into @p bytes. */
  void take(MemberId id, wire::Report report, const std::shared_ptr<const std::string>& bytes);
  /** @brief Apply the turns of the round, which is over. */
  void apply();
  /** @brief Apply the turn of @p member that is due. */
  void applyOne(MemberId id, SessionMember& member);
  /**
   * @brief Apply an item that is about @p member alone: its state after the turn, or a parameter
   * that it has asked for. @return whether @p item is one.
   */
  bool applyOwn(MemberId id, const SessionMember& member, const wire::ReportItem& item);
  /** @brief Finish a round, or an instant of a window, after all its turns are applied. */
  void finish();
  /**
   * @brief Note the members that depend on a parameter which has changed, for their next grants.
   */
  void noteChangedParameters();
  /** @brief Free the applied turns. No mail may point into them any more. */
  void forgetApplied() {
    applied_.clear();
    run_.carriage.forgetArrived();
  }

 private:
  bool changesOthers(MemberId id) const;
  bool counts(const wire::ReportItem& item) const;
  void applyItem(MemberId id, SessionMember& member, const wire::ReportItem& item);
  void applyMotion(MemberId id, const SessionMember& member, const wire::Motion& motion);
  void applyNote(SessionMember& member, const wire::Note& note);
  void applyParameter(const SessionMember& member, const wire::Parameter& item);

  LockstepRun& run_;
  RunEnd& end_;
  Departures& departures_;
  SharedFiles files_;
  std::vector<PendingTurn> applied_;  // kept while mail points into them
};

}  // namespace move_base_abstract
