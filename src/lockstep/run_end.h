// How a run ends.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_RUN_END_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_RUN_END_H

#include <string>
#include <string_view>

#include "run.h"

namespace move_base_abstract {

/** @brief How a run ends: by itself, with somebody who leaves or dies, or by the time master. */
class RunEnd {
 public:
  explicit RunEnd(LockstepRun& run) : run_(run), is_strict_(run.settings.strict) {}

  /** @brief END to everybody. Reports of a round that is not over are lost. */
  void end(const std::string& reason);
  /** @brief end(), as the settings wish. @p code: of ended_by. */
  void endAsWished(const std::string& reason, std::string_view code);
  /** @brief end(), because the wall clock or somebody outside says so; see LockstepStatus::cut. */
  void endFromOutside(const std::string& reason);
  /** @brief End, and label, a run that has lost its ROS master. */
  void loseRosMaster(const std::string& how);
  /** @brief Where the run is strict, the first label ends it. */
  void endIfLabelled();
  /** @brief The run ends with those whose departure ends it. */
  void endIfSomebodyHasGone();

  void beStrict() { is_strict_ = true; }
  /** @brief It ends, or will, while there is something left to do. */
  void cut() { is_cut_ = true; }
  /** @brief Somebody has died. */
  void degrade(const std::string& why);
  /** @brief @p member has gone: @p what, in words. */
  void noteDeparture(const SessionMember& member, const std::string& what);

  /** @return whether it ends with what has just been done: no later turns of a window count. */
  bool stopsTurns() const { return !left_.empty() || isLabelledStrictly(); }
  /** @return why nothing happens any more: of a deadlock, a zero-delay loop, the end. */
  std::string reason() const;
  /** @return what has ended it, of ended_by. */
  std::string_view code() const { return code_; }
  /** @return whose departure has ended it as end_with says, or ''. */
  std::string node() const { return code_ == ended_by::kDeparture ? left_node_ : ""; }
  bool isAsWished() const { return ended_as_wished_; }
  bool isCut() const { return is_cut_; }

 private:
  bool isLabelledStrictly() const;

  LockstepRun& run_;
  bool is_strict_;
  bool is_cut_ = false;  // see LockstepStatus
  bool ended_as_wished_ = false;
  std::string death_;  // on_death, or end_with, says that the run ends with it
  std::string left_;   // end_with says that the run ends with who left
  std::string left_node_;
  std::string reason_;  // of the end
  std::string_view code_ = ended_by::kOther;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_RUN_END_H
