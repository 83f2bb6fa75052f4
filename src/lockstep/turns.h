// What participants do in their turns comes about, in the stated order.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_TURNS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_TURNS_H

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

  /** @brief Keep what @p report tells until the round is over; its items point into @p bytes. */
  void take(MemberId id, wire::Report report, const std::shared_ptr<const std::string>& bytes);
  /** @brief The round is over. */
  void apply();
  /** @brief The one turn of @p member that is due. */
  void applyOne(MemberId id, SessionMember& member);
  /** @brief All turns of a round, or of an instant of a window, are applied. */
  void finish();
  /** @brief Who has asked for a parameter that has changed is to be told so with its next grant. */
  void noteChangedParameters();
  /** @brief No mail points into what was applied. */
  void forgetApplied() {
    applied_.clear();
    run_.carriage.forgetArrived();
  }

 private:
  bool changesOthers(MemberId id) const;
  void applyItem(MemberId id, SessionMember& member, const wire::ReportItem& item);
  void applyNote(SessionMember& member, const wire::Note& note);
  void applyParameter(const SessionMember& member, const wire::Parameter& item);

  LockstepRun& run_;
  RunEnd& end_;
  Departures& departures_;
  SharedFiles files_;
  std::vector<PendingTurn> applied_;  // kept while mail points into them
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_TURNS_H
