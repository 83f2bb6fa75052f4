// Carries out on which cores a run goes on: measures its rounds, and binds its processes. No ROS.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_CORE_KEEPER_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_CORE_KEEPER_H

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "clock/scaled_clock.h"
#include "core_binding.h"
#include "lockstep/core_choice.h"

namespace move_base_abstract {

/** @brief Not for several threads; begin() is called by the one that sends the grants. */
class CoreKeeper {
 public:
  explicit CoreKeeper(CoresWish wish) : wish_(wish), choice_(wish) {}

  void begin() { binding_.useThisThread(); }
  /** @brief A participant of this computer takes part. */
  void join(pid_t process);
  /** @brief ... no more; it may have ended. */
  void leave(pid_t process);

  /**
   * @brief To be called when something was decided, before it is sent.
   * @param rounds so far; @param owing participants that work in the latest;
   * @param wall when the decision began, ns.
   */
  void follow(std::uint64_t rounds, std::size_t owing, Nanoseconds wall);
  /** @return the wall instant [ns] at which to call follow() even if nothing comes in, or kNever.
   */
  Nanoseconds due() const;
  /** @brief Give all back: the run is over. */
  void end();

  /** @return "all" or "one (core 3)". */
  std::string text() const;

 private:
  bool isWatched() const { return wish_ != CoresWish::kAll && !is_over_; }
  void finishRound(Nanoseconds wall);
  void apply();

  const CoresWish wish_;
  CoreChoice choice_;
  CoreBinding binding_;
  bool is_over_ = false;
  bool is_new_ = false;  // somebody has joined who is not bound yet
  std::uint64_t round_ = 0;
  std::size_t grants_ = 0;  // of the round that is under way; 0: none is
  Nanoseconds begun_ = 0;   // wall, of it
  Nanoseconds children_due_ = 0;
  Nanoseconds core_due_ = 0;  // wall; when a core is asked for again, after there was none
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_CORE_KEEPER_H
