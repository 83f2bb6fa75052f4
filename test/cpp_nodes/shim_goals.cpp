// A coordinator with actionlib's SimpleActionClient, with a thread of its own that spins. It sends
// goals one after the other; some time out and are cancelled. It publishes on "results".
#include <actionlib/TestAction.h>
#include <actionlib/client/simple_action_client.h>
#include <ros/ros.h>

#include <string>

#include "teller.h"

namespace shim_goals {

using Client = actionlib::SimpleActionClient<actionlib::TestAction>;

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "goals");
  ros::NodeHandle node;
  ros::NodeHandle own("~");
  const int goals = own.param("goals", 20);
  const Teller teller("results");
  Client client("work", true);
  client.waitForServer();
  teller.tell("server is there");
  for (int k = 0; k < goals; ++k) {
    actionlib::TestGoal goal;
    goal.goal = k;
    client.sendGoal(goal);
    if (!client.waitForResult(ros::Duration(k % 5 == 4 ? 0.5 : 30.0))) {
      teller.tell("timeout of " + std::to_string(k));
      client.cancelGoal();
      client.waitForResult(ros::Duration(5.0));
    }
    teller.tell("goal " + std::to_string(k) + " " + client.getState().toString());
  }
  own.setParam("done", true);
  return 0;
}

}  // namespace shim_goals
