// Goals of actions that were sent to a participant and are not answered yet. No ROS, no time.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "lockstep/rounds/order.h"

namespace move_base_abstract {

/**
 * @brief The open goals. A goal is open from when it reaches a participant until a result with the
 * same id is sent, or its client has gone.
 *
 * The messages of all actions have the same beginning (actionlib_msgs), which is all that is read.
 */
class OpenGoals {
 public:
  enum class Part { kNone, kGoal, kResult };

  /** @return which part of an action a topic of this name and type is. */
  static Part partOf(std::string_view topic, std::string_view type);
  /** @return the topic of the results for goals that are sent on @p goal_topic. */
  static std::string resultTopic(std::string_view goal_topic);

  /**
   * @brief Note that @p client has sent @p goal. A goal without an id, or a malformed one, is
   * ignored.
   */
  void sent(MemberId client, std::string_view goal_topic, std::string_view goal);
  void answered(std::string_view result_topic, std::string_view result);
  /** @brief Note that @p goal never reaches a participant. */
  void lost(std::string_view goal_topic, std::string_view goal);
  /** @return the client that waits for @p result; 0: none, as far as is known. */
  MemberId clientOf(std::string_view result_topic, std::string_view result) const;
  /** @brief Forget the goals of @p client, which has gone. */
  void remove(MemberId client);

  std::size_t count() const { return clients_.size(); }
  /** @return {(client, action's name): number of open goals}. */
  std::map<std::pair<MemberId, std::string>, std::size_t> byAction() const;

 private:
  std::map<std::pair<std::string, std::string>, MemberId> clients_;  // by action and goal id
};

}  // namespace move_base_abstract
