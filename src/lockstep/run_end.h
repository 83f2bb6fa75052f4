// How a run ends.
#pragma once

#include <string>
#include <string_view>

#include "run.h"

namespace move_base_abstract {

/**
 * @brief Ends a run: when there is nothing left to do, when a participant leaves or dies, or when
 * the time master is told to.
 */
class RunEnd {
 public:
  explicit RunEnd(LockstepRun& run) : run_(run), is_strict_(run.settings.strict) {}

  /**
   * @brief End the run when what was sent so far is handed over. This takes one more round, in
   * which nothing that participants send counts. A later reason is ignored.
   */
  void end(const std::string& reason);
  /** @brief Send END to all participants, once nothing is left to hand over. */
  void closeIfOver();
  /** @brief End the run at once. Reports of an unfinished round are lost. */
  void endAtOnce(const std::string& reason);
  /** @brief Call end(), as the settings wish. @param code one of ended_by. */
  void endAsWished(const std::string& reason, std::string_view code);
  /** @brief Call endAtOnce() because the wall clock or a user says so, see LockstepStatus::cut. */
  void endFromOutside(const std::string& reason);
  /** @brief End and label a run that has lost its ROS master. @param how the reason, for people. */
  void loseRosMaster(const std::string& how);
  /** @brief End a strict run if it has a label. */
  void endIfLabelled();
  /** @brief End the run if a participant has gone whose departure ends it. */
  void endIfSomebodyHasGone();

  void beStrict() { is_strict_ = true; }
  /** @brief Note that the run ends, or will end, while there is something left to do. */
  void cut() { is_cut_ = true; }
  /**
   * @brief Label the run, because a participant has died. This ends the run if on_death says so.
   */
  void degrade(const std::string& why);
  /** @brief Note that @p member has gone. @param what the text that says how. */
  void noteDeparture(const SessionMember& member, const std::string& what);

  /**
   * @return whether the run ends with the turns that were applied last, so that later turns of a
   * window do not count.
   */
  bool stopsTurns() const { return !left_.empty() || has_died_ || isLabelledStrictly(); }
  /**
   * @return why nothing happens any more: the text about a deadlock, a zero-delay loop or the end.
   */
  std::string reason() const;
  /** @return the cause of the end, one of ended_by. */
  std::string_view code() const { return code_; }
  /** @return the node whose departure has ended the run as end_with says; else ''. */
  std::string node() const { return code_ == ended_by::kDeparture ? left_node_ : ""; }
  bool isAsWished() const { return ended_as_wished_; }
  bool isCut() const { return is_cut_; }

 private:
  bool isLabelledStrictly() const;
  bool isDecided() const { return run_.rounds.ended() || run_.rounds.isFinishing(); }
  void note(const std::string& reason);
  void close();

  LockstepRun& run_;
  bool is_strict_;
  bool is_cut_ = false;     // see LockstepStatus
  bool is_closed_ = false;  // END is sent
  bool ended_as_wished_ = false;
  bool has_died_ = false;  // somebody whose death ends the run, and all its turns are applied
  std::string death_;      // text about a death that ends the run, by on_death or end_with
  std::string left_;       // text about a departure that ends the run, by end_with
  std::string left_node_;
  std::string reason_;  // of the end
  std::string_view code_ = ended_by::kOther;
};

}  // namespace move_base_abstract
