// Who leaves, dies, or is told to end.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_DEPARTURES_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_DEPARTURES_H

#include <string>
#include <utility>
#include <vector>

#include "lockstep/wire/wire.h"
#include "run.h"
#include "run_end.h"

namespace move_base_abstract {

class Departures {
 public:
  Departures(LockstepRun& run, RunEnd& end) : run_(run), end_(end) {}

  void toldToEnd(MemberId id, const wire::Stopping& stopping);
  /** @brief It leaves without a grant. */
  void leave(MemberId id, const wire::Leave& leave);
  /** @brief It has reported for the last time. */
  void reportedLast(MemberId id);
  /** @brief Its connection is lost or closed. */
  void die(MemberId id, const std::string& how);
  /** @brief It goes when the round is over. @p how: "left", said of it. */
  void depart(MemberId id, const std::string& how);

  /** @return whether time stands because participants are told to end. */
  bool holdTime();
  /** @brief The round is over for @p id, which departs. */
  void apply(MemberId id);
  /** @brief After the grants: those may still contain the last words of who has gone. */
  void sayGone();

  /** @return whether all have gone together: this round's lines are nobody's. */
  bool areTogether() const { return are_together_; }
  /** @return the same, for once. */
  bool takeTogether() { return std::exchange(are_together_, false); }
  /** @return those while the run went on; the first ones. */
  const std::vector<LockstepStatus::Departure>& list() const { return list_; }

 private:
  void beginInterruption(MemberId id);
  void keepLeft(MemberId id);
  void endTogether();
  void goOnWithoutSome();
  bool goesOnWithout(MemberId id) const;

  LockstepRun& run_;
  RunEnd& end_;
  bool are_together_ = false;
  std::vector<MemberId> gone_;  // GONE is due after the next grants
  std::vector<LockstepStatus::Departure> list_;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_DEPARTURES_H
