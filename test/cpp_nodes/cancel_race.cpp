// Sends a robot to a place, and a second robot if the first is late. ~correct: without the bug.
// The bug: when the first goal is cancelled, the robot may have arrived, with its result under way.
#include <actionlib/client/simple_action_client.h>
#include <move_base_msgs/MoveBaseAction.h>
#include <ros/ros.h>

#include <boost/bind/bind.hpp>
#include <memory>

namespace cancel_race {

namespace {

using Client = actionlib::SimpleActionClient<move_base_msgs::MoveBaseAction>;
using State = actionlib::SimpleClientGoalState;

class Coordinator {
 public:
  explicit Coordinator(bool correct)
      : correct_(correct), first_("robot_1/move_base"), second_("robot_2/move_base") {
    first_.waitForServer();
    second_.waitForServer();
  }

  int visits() const { return visits_; }

  void begin() {
    send(first_, &Coordinator::onFirst);
    deadline_ = node_.createTimer(ros::Duration(10.02), &Coordinator::onDeadline, this, true);
  }

 private:
  using Callback = void (Coordinator::*)(const State&);

  void send(Client& client, Callback done) {
    move_base_msgs::MoveBaseGoal goal;
    goal.target_pose.header.frame_id = "map";
    goal.target_pose.pose.position.x = 10.0;
    goal.target_pose.pose.orientation.w = 1.0;
    client.sendGoal(goal, [this, done](const State& state, const auto&) { (this->*done)(state); });
  }

  void onDeadline(const ros::TimerEvent&) {
    first_.cancelGoal();
    if (!correct_) {
      send(second_, &Coordinator::onSecond);
    }
  }

  void onFirst(const State& state) {
    deadline_.stop();
    if (state == State::SUCCEEDED) {
      ++visits_;
    } else if (correct_) {
      send(second_, &Coordinator::onSecond);
    }
  }

  void onSecond(const State& state) { visits_ += state == State::SUCCEEDED ? 1 : 0; }

  ros::NodeHandle node_;
  bool correct_;
  Client first_;
  Client second_;
  ros::Timer deadline_;
  int visits_ = 0;
};

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "coordinator");
  Coordinator coordinator(ros::NodeHandle("~").param("correct", false));
  coordinator.begin();
  const ros::Time end = ros::Time::now() + ros::Duration(60.0);
  while (ros::ok() && ros::Time::now() < end) {
    ros::spinOnce();
    ros::Duration(0.01).sleep();
  }
  if (coordinator.visits() != 1) {
    ROS_FATAL("the place is to be visited once, got %d visits", coordinator.visits());
    return 1;
  }
  return 0;
}

}  // namespace cancel_race
