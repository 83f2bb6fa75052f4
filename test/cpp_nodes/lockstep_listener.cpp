// Prints "TIME_NS MICROSTEP TOPIC STAMP_NS" for each std_msgs/Time on ~topics, and leaves at the
// simulated instant ~until [s].
#include <move_base_abstract/lockstep_participant.h>
#include <ros/ros.h>
#include <std_msgs/Time.h>

#include <cstdio>
#include <string>
#include <vector>

namespace lockstep_listener {

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "lockstep_listener");
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const ros::NodeHandle node("~");
  move_base_abstract::lockstep::Participant participant;
  std::vector<move_base_abstract::lockstep::Subscriber> subscribers;
  for (const std::string& topic : node.param("topics", std::vector<std::string>{"/ticks"})) {
    subscribers.push_back(participant.subscribe<std_msgs::Time>(
        topic, [&participant, topic](const ros::MessageEvent<const std_msgs::Time>& event) {
          std::printf("%llu %u %s %llu\n",
                      static_cast<unsigned long long>(participant.now().toNSec()),
                      participant.microstep(), topic.c_str(),
                      static_cast<unsigned long long>(event.getMessage()->data.toNSec()));
        }));
  }
  const bool is_in_time = participant.sleepUntil(ros::Time(node.param("until", 10.0)));
  participant.leave("its time has come");
  return is_in_time ? 0 : 1;
}

}  // namespace lockstep_listener
