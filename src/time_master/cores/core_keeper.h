// Keeps a run on one core: binds its processes, and says when that makes it slow. No ROS.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "clock/scaled_clock.h"
#include "core_binding.h"

namespace move_base_abstract {

/** @brief Not thread-safe. The thread that sends the grants calls begin(). */
class CoreKeeper {
 public:
  /** @param uses_all whether nothing is bound. */
  explicit CoreKeeper(bool uses_all) : is_over_(uses_all) {}

  void begin() { binding_.useThisThread(); }
  /** @brief Add the process of a participant on this computer. */
  void join(pid_t process);
  /** @brief Remove the process of a participant, which may have ended. */
  void leave(pid_t process);

  /**
   * @brief Change the core if that is due. Call this after each decision of the session, before
   * its output is sent.
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

  /**
   * @return the cores in use: "all" or "one (core 3)", and whether other runs have it; and a hint
   * if participants often compute for long at once, which all cores would do sooner.
   */
  std::string text() const;

 private:
  void finishRound(Nanoseconds wall);
  Nanoseconds beginRound(Nanoseconds wall);

  CoreBinding binding_;
  bool is_over_;         // or never begins
  bool is_new_ = false;  // a process was added that is not bound yet
  std::uint64_t round_ = 0;
  std::size_t grants_ = 0;          // of the round under way; 0: there is none
  Nanoseconds begun_ = 0;           // wall, of this round
  Nanoseconds in_rounds_ = 0;       // wall, while one core is kept
  Nanoseconds in_common_work_ = 0;  // ... in rounds in which several compute
  Nanoseconds children_due_ = 0;
  Nanoseconds free_core_due_ = 0;  // wall; when to look for a core that no other run has
};

}  // namespace move_base_abstract
