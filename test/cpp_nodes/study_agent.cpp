// An agent as other people write it: it is seeded by the time of day, has callbacks in threads, and
// a fast loop.
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>

#include <atomic>
#include <cstdlib>
#include <ctime>

namespace study_agent {

namespace {

std::atomic<int> odometries{0};
std::atomic<int> tasks{0};

void onOdometry(const nav_msgs::Odometry::ConstPtr& /*message*/) { ++odometries; }
void onTask(const std_msgs::String::ConstPtr& message) {
  ++tasks;
  ROS_INFO("the agent saw the task '%s'", message->data.c_str());
}

}  // namespace

int nodeMain(int argc, char** argv) {
  srand(static_cast<unsigned>(time(nullptr)));
  ros::init(argc, argv, "agent");
  ros::NodeHandle node;
  const ros::Publisher battery = node.advertise<std_msgs::Float64>("battery", 10);
  const ros::Subscriber odometry = node.subscribe("odom", 10, onOdometry);
  const ros::Subscriber task = node.subscribe("tasks", 10, onTask);
  ros::AsyncSpinner spinner(2);
  spinner.start();
  double level = 100.0 - rand() % 10;
  ros::Rate rate(30.0);
  for (int k = 0; ros::ok(); ++k) {
    level -= 0.001 * (rand() % 100) + 0.0001 * odometries;
    if (k % 30 == 0) {
      std_msgs::Float64 message;
      message.data = level - tasks;
      battery.publish(message);
      ROS_INFO("battery at %.3f", message.data);
    }
    rate.sleep();
  }
  return 0;
}

}  // namespace study_agent
