// actionlib's SimpleActionServer with an execute callback, which runs in a thread of its own. A
// goal takes 1 s + 0.1 s x its number, in steps of 0.1 s, and can be preempted.
#include <actionlib/TestAction.h>
#include <actionlib/server/simple_action_server.h>
#include <ros/ros.h>

namespace shim_worker {

class Worker {
 public:
  Worker()
      : server_(
            node_, "work", [this](const actionlib::TestGoalConstPtr& goal) { execute(*goal); },
            false) {
    server_.start();
  }

 private:
  void execute(const actionlib::TestGoal& goal) {
    ros::Rate rate(10);
    for (int step = 0; step < 10 + goal.goal; ++step) {
      if (server_.isPreemptRequested() || !ros::ok()) {
        server_.setPreempted();
        return;
      }
      actionlib::TestFeedback feedback;
      feedback.feedback = step;
      server_.publishFeedback(feedback);
      rate.sleep();
    }
    actionlib::TestResult result;
    result.result = goal.goal;
    server_.setSucceeded(result);
  }

  ros::NodeHandle node_;
  actionlib::SimpleActionServer<actionlib::TestAction> server_;
};

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "worker");
  Worker worker;
  ros::spin();
  return 0;
}

}  // namespace shim_worker
