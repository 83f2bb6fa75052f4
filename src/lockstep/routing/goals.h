// Goals of actions that some participant has been sent and has not answered. No ROS, no time.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_ROUTING_GOALS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_ROUTING_GOALS_H

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "lockstep/rounds/order.h"

namespace move_base_abstract {

/**
 * @brief The book of goals: open from when a client's goal reaches a participant until a result
 * with the same id is sent, or the client has gone.
 *
 * Every action's messages begin alike (actionlib_msgs), whatever else is in them.
 */
class OpenGoals {
 public:
  enum class Part { kNone, kGoal, kResult };

  /** @return what a topic of this name and type is of an action. */
  static Part partOf(std::string_view topic, std::string_view type);
  /** @return where the results come of goals that are sent on @p goal_topic. */
  static std::string resultTopic(std::string_view goal_topic);

  /** @brief @p client has sent @p goal. Nothing if it has no id, or is no such message. */
  void sent(MemberId client, std::string_view goal_topic, std::string_view goal);
  void answered(std::string_view result_topic, std::string_view result);
  /** @return who waits for @p result; 0: nobody, as far as is known. */
  MemberId clientOf(std::string_view result_topic, std::string_view result) const;
  /** @brief @p client has gone: nobody waits for its goals. */
  void remove(MemberId client);

  std::size_t count() const { return clients_.size(); }
  /** @return {(client, action's name): how many}. */
  std::map<std::pair<MemberId, std::string>, std::size_t> byAction() const;

 private:
  std::map<std::pair<std::string, std::string>, MemberId> clients_;  // by action and goal id
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_ROUTING_GOALS_H
