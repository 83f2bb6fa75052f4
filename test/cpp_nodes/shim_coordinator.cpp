// A coordinator that sends goals to N robots over MoveBase's action topics, to compare runs.
//
// Parameters: ~robots (number), ~goals (number in all), ~seed, ~patient (default false). Names
// are robot_0 .. robot_{N-1}. Topics of robot i: publishes /robot_i/move_base/goal and
// /robot_i/move_base/cancel; listens to /robot_i/move_base/result and /robot_i/move_base/status.
// Advertised and subscribed in this order, robot by robot: goal, cancel, result, status.
//
// The exact policy, so that a program in another language sends the same messages in order:
//
//  draw():     x = x * 6364136223846793005 + 1442695040888963407 mod 2^64 (at first x = seed); the
//              value is x >> 33.
//  send(i):    sent[i] += 1; sent_in_all += 1; out_in_all += 1; out[i] += 1;
//              K = sent[i]
//              x = (draw() % 9) * 5 - 20 (few places, so that robots often arrive together)
//              publish a goal: header and goal_id.stamp and target_pose.header.stamp all 0,
//              goal_id.id = 'robot_i-K', target_pose.header.frame_id = 'map',
//              position (x, 0, 0), orientation (0, 0, 0, 1)
//  order(i):   send(i), then c = draw() % 10
//              c = 0: delay = (draw() % 50) / 10.0 s; a one-shot timer of that delay publishes a
//                     cancel (stamp 0, id of the goal just sent), in whatever state the goal is
//              c = 1: delay = (draw() % 50) / 10.0 s; a one-shot timer of that delay calls send(i)
//                     if then sent_in_all < goals (no draw follows, so no further order does)
//              otherwise nothing.
//  start:      when a status message of each robot has come: order(i) for i = 0 .. N-1 while
//              sent_in_all < goals, all at that instant, in the callback of the last one's status.
//  result:     any status, from robot i (each goal has exactly one; a replaced goal has one too):
//              out_in_all -= 1; out[i] -= 1; if sent_in_all < goals: order(i)
//              With ~patient only if out[i] = 0, too. (Without it, the first replaced goal of a
//              robot starts a chain: its result leads to one more goal, which replaces the other
//              goal, and so on at that instant until all goals are sent.)
//  end:        sent_in_all = goals and out_in_all = 0: exit code 0.
//
// Timers that are due at one instant fire in the order (due, made); messages come before timers.
// All delays are made of whole nanoseconds: (draw() % 50) * 100,000,000 ns.
#include <actionlib_msgs/GoalID.h>
#include <actionlib_msgs/GoalStatusArray.h>
#include <move_base_msgs/MoveBaseActionGoal.h>
#include <move_base_msgs/MoveBaseActionResult.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace shim_coordinator {

namespace {

struct Robot {
  std::string name;
  ros::Publisher goal;
  ros::Publisher cancel;
  ros::Subscriber result;
  ros::Subscriber status;
  bool is_there = false;
  int sent = 0;
  int out = 0;
};

class Coordinator {
 public:
  explicit Coordinator(const ros::NodeHandle& parameters)
      : goals_(parameters.param("goals", 10)),
        is_patient_(parameters.param("patient", false)),
        x_(static_cast<std::uint64_t>(parameters.param("seed", 1))),
        robots_(static_cast<std::size_t>(parameters.param("robots", 1))) {
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      Robot& robot = robots_[i];
      robot.name = "robot_" + std::to_string(i);
      const std::string action = "/" + robot.name + "/move_base";
      robot.goal = node_.advertise<move_base_msgs::MoveBaseActionGoal>(action + "/goal", 10);
      robot.cancel = node_.advertise<actionlib_msgs::GoalID>(action + "/cancel", 10);
      robot.result = node_.subscribe<move_base_msgs::MoveBaseActionResult>(
          action + "/result", 0,
          [this, &robot](const move_base_msgs::MoveBaseActionResultConstPtr&) { finished(robot); });
      robot.status = node_.subscribe<actionlib_msgs::GoalStatusArray>(
          action + "/status", 0,
          [this, &robot](const actionlib_msgs::GoalStatusArrayConstPtr&) { appeared(robot); });
    }
  }

  /** Work until all results have come. */
  void run() {
    while (ros::ok() && (sent_ < goals_ || out_ > 0)) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(3600.0));
      for (const auto& action : std::exchange(at_once_, {})) {
        action();
      }
    }
  }

 private:
  std::uint64_t draw() {
    x_ = x_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return x_ >> 33;
  }

  double drawCoordinate() { return static_cast<double>(draw() % 9) * 5.0 - 20.0; }

  void appeared(Robot& robot) {
    if (robot.is_there) {
      return;
    }
    robot.is_there = true;
    if (++there_ < robots_.size()) {
      return;
    }
    for (Robot& each : robots_) {
      if (sent_ < goals_) {
        order(each);
      }
    }
  }

  void finished(Robot& robot) {
    --out_;
    --robot.out;
    if (sent_ < goals_ && (!is_patient_ || robot.out == 0)) {
      order(robot);
    }
  }

  std::string send(Robot& robot) {
    ++robot.sent;
    ++sent_;
    ++out_;
    ++robot.out;
    move_base_msgs::MoveBaseActionGoal message;
    message.goal_id.id = robot.name + "-" + std::to_string(robot.sent);
    message.goal.target_pose.header.frame_id = "map";
    message.goal.target_pose.pose.position.x = drawCoordinate();
    message.goal.target_pose.pose.orientation.w = 1.0;
    robot.goal.publish(message);
    return message.goal_id.id;
  }

  void order(Robot& robot) {
    const std::string id = send(robot);
    switch (draw() % 10) {
      case 0:
        after(drawDelay(), [&robot, id] {
          actionlib_msgs::GoalID cancel;
          cancel.id = id;
          robot.cancel.publish(cancel);
        });
        break;
      case 1:
        after(drawDelay(), [this, &robot] {
          if (sent_ < goals_) {
            send(robot);
          }
        });
        break;
      default:
        break;
    }
  }

  ros::Duration drawDelay() {
    return ros::Duration().fromNSec(static_cast<std::int64_t>(draw() % 50) * 100'000'000);
  }

  void after(const ros::Duration& delay, const std::function<void()>& action) {
    if (delay.isZero()) {
      at_once_.push_back(action);  // a timer would fire in the next round
      return;
    }
    timers_.push_back(node_.createTimer(
        delay, [action](const ros::TimerEvent&) { action(); }, true));
  }

  const int goals_;
  const bool is_patient_;
  std::uint64_t x_;
  ros::NodeHandle node_;
  std::vector<Robot> robots_;
  std::vector<ros::Timer> timers_;
  std::vector<std::function<void()>> at_once_;
  std::size_t there_ = 0;
  int sent_ = 0;
  int out_ = 0;
};

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "coordinator");
  Coordinator(ros::NodeHandle("~")).run();
  return 0;
}

}  // namespace shim_coordinator
