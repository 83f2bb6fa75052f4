// A participant whose work on one grant takes long says where it is.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_SILENCE_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_SILENCE_H

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>

#include "clock/scaled_clock.h"

namespace move_base_abstract::lockstep::internal {

/** @brief Looks, in a thread of its own, for how long a grant is being worked on. */
class SilenceWatch {
 public:
  /** @return the number of the round that is being worked on; 0: none. */
  using Granted = std::function<std::uint64_t()>;
  /** @brief The work on this round takes long; called once for each. */
  using Tell = std::function<void(std::uint64_t)>;

  ~SilenceWatch() { end(); }

  /** @param limit wall ns; kNever: nothing is watched. Once. */
  void begin(Nanoseconds limit, Granted granted, Tell tell);
  void end();

 private:
  void watch(Nanoseconds limit, const Granted& granted, const Tell& tell) const;

  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_SILENCE_H
