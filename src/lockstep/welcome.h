// What the time master decides for every participant, and tells each in its WELCOME.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_WELCOME_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_WELCOME_H

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "clock/scaled_clock.h"
#include "interruption.h"
#include "lockstep/rounds/order.h"
#include "lockstep/rounds/settings.h"
#include "lockstep/wire/wire.h"

namespace move_base_abstract {

/** @brief Of nodes that declare no rank: they come after the robots, which have 0. */
constexpr std::int32_t kDefaultRank = 1000;

/** @brief How long a connection that was told the end may take to close [ns, wall]. */
constexpr Nanoseconds kLeaveLimit = kNanosecondsPerSecond;

/** @brief How long one that goes waits for its last words to be taken [ns, wall]: longer than time
 * stands because it was told to end. */
constexpr Nanoseconds kLastWordsLimit = Interruption::kGrace + kNanosecondsPerSecond;

/** @return the rank that a newcomer gets. */
inline std::int32_t rankOf(const wire::Hello& hello) {
  return hello.rank_declared ? hello.rank : kDefaultRank;
}

/**
 * @brief Whether ROS made the name unique: with the wall time, of which rospy gives ms behind a
 * process number ("_4711_1600000000000") and roscpp ns.
 */
bool isAnonymous(std::string_view name);

/**
 * @return the topics that do not go through the time master, as @p node ("/robot_1/driver") sees
 * them: those that never do, and those of the setting, in which a name without '/' is below the
 * node's namespace, and one behind '~' below the node itself.
 */
std::vector<std::string> excludedTopics(const LockstepSettings& settings, std::string_view node);

/** @return the frame that answers a HELLO. */
std::string encodeWelcome(MemberId id, const wire::Hello& hello, const LockstepSettings& settings);

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_WELCOME_H
