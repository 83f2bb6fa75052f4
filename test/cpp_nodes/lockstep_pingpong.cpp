// Two of these nodes throw a number to each other on the topics ~from and ~to; the one with ~begin
// throws first.
// A throw takes no simulated time except the ~pause [s] before it (0: none). After ~rounds each
// prints the rate and leaves. With ~verbose, each catch is printed as "TIME_NS NUMBER".
#include <move_base_abstract/lockstep_participant.h>
#include <ros/ros.h>
#include <std_msgs/UInt32.h>

#include <cstdio>

namespace lockstep_pingpong {

namespace {

class Player {
 public:
  Player() : node_("~") {
    pause_ = ros::Duration(node_.param("pause", 0.0));
    rounds_ = static_cast<std::uint32_t>(node_.param("rounds", 10));
    is_verbose_ = node_.param("verbose", false);
    publisher_ =
        participant_.advertise<std_msgs::UInt32>(node_.param<std::string>("to", "to"), true);
    subscriber_ = participant_.subscribe<std_msgs::UInt32>(
        node_.param<std::string>("from", "from"), [this](const std_msgs::UInt32& m) { take(m); });
  }

  void play() {
    if (node_.param("begin", false)) {
      publisher_.publish(std_msgs::UInt32());
    }
    const ros::WallTime begin = ros::WallTime::now();
    participant_.spin();
    const double wall = (ros::WallTime::now() - begin).toSec();
    std::printf("%u rounds in %.3f s: %.0f rounds/s\n", rounds_, wall, rounds_ / wall);
  }

 private:
  void take(const std_msgs::UInt32& message) {
    if (is_verbose_) {
      std::printf("%llu %u\n", static_cast<unsigned long long>(participant_.now().toNSec()),
                  message.data);
    }
    if (pause_ > ros::Duration(0)) {
      participant_.sleep(pause_);
    }
    std_msgs::UInt32 next;
    next.data = message.data + 1;
    publisher_.publish(next);
    if (message.data + 2 >= 2 * rounds_) {
      participant_.leave("all rounds are played");
    }
  }

  ros::NodeHandle node_;
  move_base_abstract::lockstep::Participant participant_;
  ros::Duration pause_;
  std::uint32_t rounds_ = 0;
  bool is_verbose_ = false;
  move_base_abstract::lockstep::Publisher publisher_;
  move_base_abstract::lockstep::Subscriber subscriber_;
};

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "lockstep_pingpong");
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  Player().play();
  return 0;
}

}  // namespace lockstep_pingpong
