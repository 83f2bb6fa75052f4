// What a node of the tests says on a topic.
#pragma once

#include <ros/ros.h>
#include <std_msgs/String.h>

#include <string>

class Teller {
 public:
  explicit Teller(const std::string& topic)
      : publisher_(node_.advertise<std_msgs::String>(topic, 1000)) {}

  void say(const std::string& text) const {
    std_msgs::String message;
    message.data = text;
    publisher_.publish(message);
  }
  /** Say a text after the time [ns]. */
  void tell(const std::string& text) const {
    say(std::to_string(ros::Time::now().toNSec()) + " " + text);
  }

 private:
  ros::NodeHandle node_;
  ros::Publisher publisher_;
};
