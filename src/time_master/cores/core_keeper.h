// Keeps a run on the cores that are chosen: measures its rounds, and binds its processes. No ROS.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_CORES_CORE_KEEPER_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_CORES_CORE_KEEPER_H

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "clock/scaled_clock.h"
#include "core_binding.h"
#include "lockstep/core_choice.h"

namespace move_base_abstract {

/** @brief Not thread-safe. The thread that sends the grants calls begin(). */
class CoreKeeper {
 public:
  /**
   * @param has_lookahead whether the run has one: then all participants work at once, so each is
   * kept on a core of its own, as far as there are enough. Otherwise all are kept on the same one.
   */
  CoreKeeper(CoresWish wish, bool has_lookahead);

  void begin() { binding_.useThisThread(); }
  /** @brief Add the process of a participant on this computer. */
  void join(pid_t process);
  /** @brief Remove the process of a participant, which may have ended. */
  void leave(pid_t process);

  /**
   * @brief Measure a round, and change the cores if that is due. Call this after each decision of
   * the session, before its output is sent.
   * @param rounds the number of rounds so far.
   * @param owing the number of participants that work in the latest round.
   * @param wall the wall instant [ns] at which the decision began.
   */
  void follow(std::uint64_t rounds, std::size_t owing, Nanoseconds wall);
  /**
   * @return the wall instant [ns] at which to call follow() even if nothing is received, or kNever.
   */
  Nanoseconds due() const;
  /** @brief Give all processes their cores back, because the run is over. */
  void end();

  /** @return the cores in use: "all", "one (core 3)", or "one each (cores 0, 3)". */
  std::string text() const;

 private:
  bool isWatched() const { return wish_ != CoresWish::kAll && !is_over_; }
  bool isApart() const { return layout_ == CoreLayout::kApart; }
  void finishRound(Nanoseconds wall);
  void apply();

  const CoresWish wish_;
  const CoreLayout layout_;
  CoreChoice choice_;
  CoreBinding binding_;
  bool is_over_ = false;
  bool is_new_ = false;  // a process was added that is not bound yet
  std::uint64_t round_ = 0;
  std::size_t grants_ = 0;  // of the round under way; 0: there is none
  Nanoseconds begun_ = 0;   // wall, of this round
  Nanoseconds children_due_ = 0;
  Nanoseconds core_due_ = 0;  // wall; when to try again, after there was no core
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_CORES_CORE_KEEPER_H
