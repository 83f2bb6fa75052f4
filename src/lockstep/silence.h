// Messages about participants whose work on one grant takes long.
#pragma once

#include "departures.h"
#include "lockstep/wire/wire.h"
#include "run.h"

namespace move_base_abstract {

class Silence {
 public:
  Silence(LockstepRun& run, Departures& departures) : run_(run), departures_(departures) {}

  /**
   * @brief Report that a participant is silent, and drop it if on_silence says so, or report that
   * it has answered at last.
   */
  void handle(const LockstepRounds::Event& event);
  /** @brief Take a participant's text about what its thread does. */
  void takeBusy(MemberId id, const wire::Busy& busy);

 private:
  LockstepRun& run_;
  Departures& departures_;
};

}  // namespace move_base_abstract
