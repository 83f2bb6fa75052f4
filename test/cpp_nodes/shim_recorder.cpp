// Prints the time, topic and text of each std_msgs/String message on ~topics.
#include <ros/ros.h>
#include <std_msgs/String.h>

#include <cstdio>
#include <string>
#include <vector>

namespace shim_recorder {

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "recorder");
  ros::NodeHandle node;
  std::vector<std::string> topics;
  ros::NodeHandle("~").getParam("topics", topics);
  std::vector<ros::Subscriber> subscribers;
  for (const std::string& topic : topics) {
    const boost::function<void(const std_msgs::String::ConstPtr&)> print =
        [topic](const std_msgs::String::ConstPtr& message) {
          std::printf("%llu %s %s\n", static_cast<unsigned long long>(ros::Time::now().toNSec()),
                      topic.c_str(), message->data.c_str());
        };
    subscribers.push_back(node.subscribe<std_msgs::String>(topic, 1000, print));
  }
  ros::spin();
  std::fflush(stdout);
  return 0;
}

}  // namespace shim_recorder
