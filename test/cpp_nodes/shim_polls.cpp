// A program that waits by looking: by the wall clock for a subscriber, without any wait for
// messages and for time, and for a latched message, which is there at once.
#include <ros/ros.h>
#include <std_msgs/String.h>

#include <string>

#include "teller.h"

namespace shim_polls {

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "polls");
  ros::NodeHandle node;
  const Teller teller("/told");
  ros::Publisher publisher = node.advertise<std_msgs::String>("polled", 10);
  while (publisher.getNumSubscribers() == 0) {
    ros::WallDuration(0.01).sleep();
  }
  teller.tell("somebody listens");
  int heard = 0;
  const auto subscriber = node.subscribe<std_msgs::String>(
      "ticks", 10, [&heard](const std_msgs::String::ConstPtr&) { ++heard; });
  while (ros::ok() && heard < 5) {
    ros::spinOnce();
  }
  teller.tell("five are heard");
  const ros::Time end = ros::Time::now() + ros::Duration(0.01);
  int looks = 1;
  for (; ros::Time::now() < end; ++looks) {
  }
  teller.tell("time has gone on after " + std::to_string(looks) + " looks");
  const ros::Publisher latched = node.advertise<std_msgs::String>("latched", 1, true);
  latched.publish(std_msgs::String());
  const ros::Time later = ros::Time::now() + ros::Duration(0.02);
  while (ros::Time::now() < later) {
    ros::topic::waitForMessage<std_msgs::String>("latched", node);
  }
  teller.tell("a latched message was there each time");
  return 0;
}

}  // namespace shim_polls
