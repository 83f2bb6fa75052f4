// The services of the time master that a debugger uses.
#pragma once

#include <move_base_abstract/RecentMessages.h>
#include <move_base_abstract/SetLooking.h>
#include <move_base_abstract/StopWhen.h>
#include <ros/ros.h>

#include <functional>
#include <string>
#include <vector>

#include "lockstep_server.h"

namespace move_base_abstract {

/** @brief Answers them for the mode that is on. For one thread. */
class DebuggerServices {
 public:
  /**
   * @param server gives the server of lockstep; null on the scaled clock.
   * @param changed is called after each call that was not refused.
   */
  DebuggerServices(ros::NodeHandle& own, std::function<LockstepServer*()> server,
                   std::function<void()> changed);

 private:
  template <typename Response, typename Action>
  bool answer(const char* service, const char* instead, Response& response, Action action);
  bool onStopWhen(StopWhen::Request& request, StopWhen::Response& response);
  bool onRecent(RecentMessages::Request& request, RecentMessages::Response& response);
  bool onLooking(SetLooking::Request& request, SetLooking::Response& response);

  std::function<LockstepServer*()> server_;
  std::function<void()> changed_;
  std::vector<ros::ServiceServer> services_;
};

}  // namespace move_base_abstract
