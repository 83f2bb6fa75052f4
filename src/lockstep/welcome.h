// The values that the time master decides for a participant, and sends in its WELCOME.
#pragma once

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

/** @brief The rank of nodes that declare none. They come after the robots, which have 0. */
constexpr std::int32_t kDefaultRank = 1000;

/** @brief The time that a connection may take to close after END [ns, wall]. */
constexpr Nanoseconds kLeaveLimit = kNanosecondsPerSecond;

/**
 * @brief The time that a leaving participant waits until its last actions are taken [ns, wall]. It
 * is longer than the time for which a signal to end makes simulated time stand.
 */
constexpr Nanoseconds kLastWordsLimit = Interruption::kGrace + kNanosecondsPerSecond;

/** @return the rank of a newcomer. */
inline std::int32_t rankOf(const wire::Hello& hello) {
  return hello.rank_declared ? hello.rank : kDefaultRank;
}

/**
 * @brief Whether ROS made the name unique with the wall time. rospy adds a process number and ms
 * ("_4711_1600000000000"), roscpp adds ns.
 */
bool isAnonymous(std::string_view name);

/**
 * @return the topics that do not go through the time master, for @p node ("/robot_1/driver"). These
 * are the topics that never do, and those of the setting. In the setting, a name without '/' is
 * below the node's namespace, and a name after '~' is below the node itself.
 */
std::vector<std::string> excludedTopics(const LockstepSettings& settings, std::string_view node);

/** @return the frame that answers a HELLO. */
std::string encodeWelcome(MemberId id, const wire::Hello& hello, const LockstepSettings& settings);

}  // namespace move_base_abstract
