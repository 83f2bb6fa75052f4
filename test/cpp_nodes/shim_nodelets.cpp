// Nodelets as users write them: one counts by a timer, the other adds in several threads.
#include <nodelet/nodelet.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

#include <pluginlib/class_list_macros.hpp>

namespace shim_nodelets {

class Counter : public nodelet::Nodelet {
  void onInit() override {
    publisher_ = getPrivateNodeHandle().advertise<std_msgs::Float64>("out", 10);
    timer_ = getNodeHandle().createTimer(ros::Duration(0.1), [this](const ros::TimerEvent&) {
      const std_msgs::Float64Ptr message(new std_msgs::Float64);
      message->data = ++count_;
      publisher_.publish(message);
    });
  }

  int count_ = 0;
  ros::Publisher publisher_;
  ros::Timer timer_;
};

class Plus : public nodelet::Nodelet {
  void onInit() override {
    publisher_ = getPrivateNodeHandle().advertise<std_msgs::Float64>("out", 10);
    const boost::function<void(const std_msgs::Float64ConstPtr&)> add =
        [this](const std_msgs::Float64ConstPtr& number) {
          const std_msgs::Float64Ptr message(new std_msgs::Float64);
          message->data = number->data + 1000;
          publisher_.publish(message);
        };
    subscriber_ = getMTPrivateNodeHandle().subscribe<std_msgs::Float64>("in", 10, add);
  }

  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
};

}  // namespace shim_nodelets

PLUGINLIB_EXPORT_CLASS(shim_nodelets::Counter, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(shim_nodelets::Plus, nodelet::Nodelet)
