// What happens to a run when signals tell its participants to end, at instants of the wall clock.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"
#include "connections.h"
#include "lockstep/rounds/order.h"

namespace move_base_abstract {

/**
 * @brief Participants that a signal told to end, or that leave without a grant.
 *
 * A signal to one of them may be the first of signals to all, in any order (Ctrl-C, roslaunch). So
 * time stands as soon as the first of them ends, and the labels that its end would give the run are
 * kept back. They count only if others are still there when no other participant has ended for a
 * while. `wall` is a monotonic wall instant in ns.
 */
class Interruption {
 public:
  /** @brief A label that the run gets if it goes on. */
  struct Label {
    enum class Kind { kLeft, kInput, kDied };
    Kind kind;
    MemberId member;
    std::string text;
  };

  /**
   * Wall time without another end, after which the run goes on without the participants that have
   * ended.
   */
  static constexpr Nanoseconds kGrace = 2 * kNanosecondsPerSecond;
  /** Wall time for which the run waits for a process that was told to end. */
  static constexpr Nanoseconds kPatience = 20 * kNanosecondsPerSecond;

  /**
   * @brief A participant was told to end, or has left without a grant. @param at_rest whether the
   * run was at rest.
   */
  void begin(MemberId id, ConnectionId connection, Nanoseconds wall, bool at_rest);
  /**
   * @brief A participant wants a grant for its last actions. It does not end before it gets one.
   */
  void knocked(MemberId id);
  void lost(ConnectionId connection, Nanoseconds wall);
  void keep(Label label) { labels_.push_back(std::move(label)); }

  bool isActive() const { return active_; }
  /** @return whether the run was at rest when the first participant was told to end. */
  bool rested() const { return rested_; }
  /**
   * @return the participants that were told to end and have not ended yet, and since when [wall
   * ns].
   */
  std::map<MemberId, Nanoseconds> ending() const;
  bool concerns(MemberId id) const { return concerned_.count(id) != 0; }
  /**
   * @return the wall instant [ns] at which the run goes on with the participants that stay; kNever:
   * there is no interruption.
   */
  Nanoseconds due() const;

  /** @brief End the interruption. @return the labels that were kept back. */
  std::vector<Label> finish();

 private:
  struct Concerned {
    ConnectionId connection;  // 0: closed
    Nanoseconds since;        // wall
    bool knocked;
  };

  bool active_ = false;
  bool rested_ = false;
  Nanoseconds last_ = 0;  // wall, when the latest one ended
  std::map<MemberId, Concerned> concerned_;
  std::vector<Label> labels_;
};

}  // namespace move_base_abstract
