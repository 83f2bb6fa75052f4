// What becomes of a run whose participants are told to end, at moments of the wall clock.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_INTERRUPTION_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_INTERRUPTION_H

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"
#include "connections.h"
#include "lockstep/rounds/order.h"

namespace move_base_abstract {

/**
 * @brief Participants that are told to end by a signal, or go without a grant.
 *
 * Whoever ends one of them may be about to end them all, in any order (Ctrl-C, roslaunch). So time
 * is held as soon as the first of them goes, and what its end would say of the run is kept back:
 * it is said only if others are still there when nobody else has gone for a while. `wall` is a
 * monotonic wall instant in ns.
 */
class Interruption {
 public:
  /** @brief Something to say of the run if it goes on. */
  struct Label {
    enum class Kind { kLeft, kInput, kDied };
    Kind kind;
    MemberId member;
    std::string text;
  };

  /** Wall; so long nobody must have gone until the run goes on without those that have. */
  static constexpr Nanoseconds kGrace = 2 * kNanosecondsPerSecond;
  /** Wall; so long a process that is told to end is waited for. */
  static constexpr Nanoseconds kPatience = 20 * kNanosecondsPerSecond;

  /** @brief A participant is told to end, or has left without a grant, while the run was at rest,
   * or was not. */
  void begin(MemberId id, ConnectionId connection, Nanoseconds wall, bool at_rest);
  /** @brief It wants a grant for its last words: it does not go before. */
  void knocked(MemberId id);
  void lost(ConnectionId connection, Nanoseconds wall);
  void keep(Label label) { labels_.push_back(std::move(label)); }

  bool isActive() const { return active_; }
  /** @return whether the run was at rest when the first of them was told to end. */
  bool rested() const { return rested_; }
  /** @return who is told to end and has not yet, and since when [wall ns]. */
  std::map<MemberId, Nanoseconds> ending() const;
  bool concerns(MemberId id) const { return concerned_.count(id) != 0; }
  /** @return the wall instant [ns] at which the run goes on with those who stay; kNever: none. */
  Nanoseconds due() const;

  /** @brief It is over. @return what was kept back. */
  std::vector<Label> finish();

 private:
  struct Concerned {
    ConnectionId connection;  // 0: closed
    Nanoseconds since;        // wall
    bool knocked;
  };

  bool active_ = false;
  bool rested_ = false;
  Nanoseconds last_ = 0;  // wall; somebody went
  std::map<MemberId, Concerned> concerned_;
  std::vector<Label> labels_;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_INTERRUPTION_H
