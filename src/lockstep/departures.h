// How a participant leaves: by itself, because its process died, or because a signal told it to
// end.
#pragma once

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
  /** @brief A participant leaves without a grant. */
  void leave(MemberId id, const wire::Leave& leave);
  /** @brief A participant has sent its last report. */
  void reportedLast(MemberId id);
  /** @brief A participant's connection is lost: its process has crashed, or somebody killed it. */
  void lose(MemberId id);
  /** @brief A participant dies. @param how why, for people. */
  void die(MemberId id, const std::string& how);
  /**
   * @brief Remove a participant when the round is over. @param how the verb for messages, such as
   * "left".
   */
  void depart(MemberId id, const std::string& how);

  /** @return whether time stands because participants were told to end. */
  bool holdTime();
  /** @brief Remove @p id, which departs, as the round is over. */
  void apply(MemberId id);
  /**
   * @brief Send GONE for the members that have departed. Call this after the grants, which may
   * still contain their last messages.
   */
  void sayGone();

  /**
   * @return whether all participants have gone together, so that the lines of this round do not
   * count.
   */
  bool areTogether() const { return are_together_; }
  /** @return the same, and reset it. */
  bool takeTogether() { return std::exchange(are_together_, false); }
  /** @return the departures while the run went on, up to a limit. */
  const std::vector<LockstepStatus::Departure>& list() const { return list_; }

 private:
  void beginInterruption(MemberId id);
  void keepLeft(MemberId id);
  void endTogether();
  void goOnWithoutSome();
  bool goesOnWithout(MemberId id) const;
  bool mayKeep(MemberId id) const;

  LockstepRun& run_;
  RunEnd& end_;
  bool are_together_ = false;
  std::vector<MemberId> gone_;  // to be named in GONE after the next grants
  std::vector<LockstepStatus::Departure> list_;
};

}  // namespace move_base_abstract
