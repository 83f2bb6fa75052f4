// A timer that publishes: the smallest participant, which measures ticks per second of wall time.
//
// Parameters: ~period [s, simulated], ~ticks (0: without end), ~topic. It publishes the time of
// each tick. After the last tick it prints the rate and the number of listeners, and leaves.
#include <move_base_abstract/lockstep_participant.h>
#include <ros/ros.h>
#include <std_msgs/Time.h>

#include <cstdint>
#include <cstdio>

namespace lockstep_ticker {

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "lockstep_ticker");
  ros::NodeHandle node("~");
  const double period = node.param("period", 1.0);
  const int ticks = node.param("ticks", 0);
  const std::string topic = node.param<std::string>("topic", "/ticks");

  move_base_abstract::lockstep::Participant participant;
  const auto publisher = participant.advertise<std_msgs::Time>(topic);
  int done = 0;
  std::uint32_t listeners = 0;
  const ros::WallTime begin = ros::WallTime::now();
  const auto timer =
      participant.createTimer(ros::Duration(period), [&](const ros::TimerEvent& event) {
        std_msgs::Time message;
        message.data = event.current_real;
        publisher.publish(message);
        listeners = publisher.getNumSubscribers();
        if (++done == ticks) {
          participant.leave("all ticks are done");
        }
      });
  participant.spin();
  const double wall = (ros::WallTime::now() - begin).toSec();
  std::printf("%d ticks in %.3f s: %.0f ticks/s\n", done, wall, done / wall);
  std::printf("%u listeners\n", listeners);
  return 0;
}

}  // namespace lockstep_ticker
