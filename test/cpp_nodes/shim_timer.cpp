// ros::Timer of all kinds: two periods that meet, and a one-shot timer that starts another one.
// Each publishes on "fired", with expected and real time.
#include <ros/ros.h>

#include <sstream>
#include <string>

#include "teller.h"

namespace shim_timer {

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "timers");
  ros::NodeHandle node;
  const Teller teller("fired");
  const auto tell = [&teller](const std::string& name) {
    return [&teller, name](const ros::TimerEvent& event) {
      std::ostringstream text;
      text << name << " expected " << event.current_expected << " real " << event.current_real
           << " last " << event.last_real;
      teller.say(text.str());
    };
  };
  ros::Timer again;
  const ros::TimerCallback start = [&](const ros::TimerEvent& event) {
    tell("once")(event);
    again = node.createTimer(ros::Duration(2), ros::TimerCallback(tell("again")));
  };
  const auto fast = node.createTimer(ros::Duration(0.1), ros::TimerCallback(tell("fast")));
  const auto slow = node.createTimer(ros::Duration(0.3), ros::TimerCallback(tell("slow")));
  const auto once = node.createTimer(ros::Duration(1.05), start, true);
  ros::spin();
  return 0;
}

}  // namespace shim_timer
