// Measures the practical limit of topics on this machine: two roscpp nodes send one small message
// to and fro. usage: bench_ping_pong pong | bench_ping_pong ping COUNT (prints round trips/s)
#include <ros/ros.h>
#include <std_msgs/UInt64.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

constexpr std::uint64_t kWarmUp = 200;

int pong() {
  ros::NodeHandle node;
  ros::Publisher answer = node.advertise<std_msgs::UInt64>("/bench/pong", 10);
  ros::Subscriber question = node.subscribe<std_msgs::UInt64>(
      "/bench/ping", 10,
      [&answer](const std_msgs::UInt64::ConstPtr& message) { answer.publish(*message); },
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  ros::spin();
  return 0;
}

int ping(std::uint64_t count) {
  ros::NodeHandle node;
  ros::Publisher question = node.advertise<std_msgs::UInt64>("/bench/ping", 10);
  ros::WallTime begin;
  std_msgs::UInt64 number;
  const auto next = [&](const std_msgs::UInt64::ConstPtr& message) {
    number.data = message->data + 1;
    if (number.data == kWarmUp) {
      begin = ros::WallTime::now();
    }
    if (number.data < kWarmUp + count) {
      question.publish(number);
    } else {
      ros::requestShutdown();
    }
  };
  ros::Subscriber answer = node.subscribe<std_msgs::UInt64>(
      "/bench/pong", 10, next, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  while (ros::ok() && (question.getNumSubscribers() == 0 || answer.getNumPublishers() == 0)) {
    ros::WallDuration(0.01).sleep();
  }
  question.publish(number);
  ros::spin();
  std::printf("%.1f\n", static_cast<double>(count) / (ros::WallTime::now() - begin).toSec());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, argc > 2 ? "bench_ping" : "bench_pong", ros::init_options::NoRosout);
  return argc > 2 ? ping(std::strtoull(argv[2], nullptr, 10)) : pong();
}
