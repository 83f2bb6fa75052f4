// With a lookahead: applies the turns that participants have had by themselves.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "departures.h"
#include "lockstep/wire/wire.h"
#include "run.h"
#include "run_end.h"
#include "turns.h"

namespace move_base_abstract {

class WalkedTurns {
 public:
  WalkedTurns(LockstepRun& run, RunEnd& end, Departures& departures, Turns& turns)
      : run_(run), end_(end), departures_(departures), turns_(turns) {}

  /**
   * @brief Keep the turns of @p report until no member can act before them. Its items point into @p
   * bytes.
   * @throws wire::MalformedFrame if it sets an invalid parameter, or an instant is out of order.
   */
  void take(MemberId id, wire::Report report, const std::shared_ptr<const std::string>& bytes);
  /**
   * @brief Apply the turns of all instants before which no member can have a turn any more, in the
   * order of time. If the run ends with one of them, later ones are not applied.
   */
  void apply();

 private:
  /** @brief A ROS parameter that was set or deleted in such a turn. */
  struct Set {
    Nanoseconds at = 0;  // simulated
    MailOrder order;
    std::string by;                            // the node's name
    std::shared_ptr<const std::string> frame;  // that `item` points into
    wire::Parameter item;
  };

  void takeAtOnce(MemberId id, std::deque<WalkedTurn>* turns);
  void applyInstant(Nanoseconds at);
  void applyAfterEnd();
  void applyGone();
  void applySets(Nanoseconds until);
  Nanoseconds first() const;

  LockstepRun& run_;
  RunEnd& end_;
  Departures& departures_;
  Turns& turns_;
  std::vector<Set> sets_;  // not told to the ROS master yet
};

}  // namespace move_base_abstract
