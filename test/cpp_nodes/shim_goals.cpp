// A coordinator with actionlib's SimpleActionClient, by default with a thread of its own that
// spins. It sends goals one after the other; some time out and are cancelled. It publishes on
// "results".
#include <actionlib/TestAction.h>
#include <actionlib/client/simple_action_client.h>
#include <ros/ros.h>
#include <std_msgs/String.h>

#include <string>

#include "machine_time.h"

namespace shim_goals {

using Client = actionlib::SimpleActionClient<actionlib::TestAction>;

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "goals");
  ros::NodeHandle node;
  bool spin_thread = true;
  int goals = 20;
  ros::NodeHandle own("~");
  own.param("spin_thread", spin_thread, spin_thread);
  own.param("goals", goals, goals);
  ros::Publisher publisher = node.advertise<std_msgs::String>("results", 100);
  const auto tell = [&publisher](const std::string& text) {
    std_msgs::String message;
    message.data = std::to_string(ros::Time::now().toNSec()) + " " + text;
    publisher.publish(message);
  };
  Client client("work", spin_thread);
  client.waitForServer();
  tell("server is there");
  const double wall_begin = machineTime();
  for (int k = 0; k < goals; ++k) {
    actionlib::TestGoal goal;
    goal.goal = k;
    client.sendGoal(goal);
    if (!client.waitForResult(ros::Duration(k % 5 == 4 ? 0.5 : 30.0))) {
      tell("timeout of " + std::to_string(k));
      client.cancelGoal();
      client.waitForResult(ros::Duration(5.0));
    }
    tell("goal " + std::to_string(k) + " " + client.getState().toString());
  }
  const double wall = machineTime() - wall_begin;
  own.setParam("goals_per_second", goals / wall);
  own.setParam("done", true);
  ROS_INFO("%d goals, %.0f goals/s", goals, goals / wall);
  return 0;
}

}  // namespace shim_goals
