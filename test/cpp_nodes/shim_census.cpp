// A program that lists topics and nodes at the start, and asks for topics until /late is there.
#include <ros/ros.h>

#include <algorithm>
#include <cstdio>
#include <string>

namespace shim_census {

namespace {

bool isLink(const std::string& name) { return name.find("/link_") == 0; }

bool isLateThere() {
  ros::master::V_TopicInfo topics;
  ros::master::getTopics(topics);
  return std::any_of(topics.begin(), topics.end(),
                     [](const ros::master::TopicInfo& topic) { return topic.name == "/late"; });
}

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "counter");
  ros::NodeHandle node;
  ros::master::V_TopicInfo topics;
  ros::master::getTopics(topics);
  std::printf("%.9f topics", ros::Time::now().toSec());
  for (const ros::master::TopicInfo& topic : topics) {
    std::printf(isLink(topic.name) ? " %s" : "", topic.name.c_str());
  }
  std::printf("\n");
  ros::V_string nodes;
  ros::master::getNodes(nodes);
  std::printf("%.9f %d nodes\n", ros::Time::now().toSec(),
              static_cast<int>(std::count_if(nodes.begin(), nodes.end(), isLink)));
  while (ros::ok() && !isLateThere()) {
  }
  std::printf("%.9f late\n", ros::Time::now().toSec());
  return 0;
}

}  // namespace shim_census
