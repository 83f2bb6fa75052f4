// Plays a fixed script as the only participant and prints "TIME_NS MICROSTEP WHAT" for each event.
#include <move_base_abstract/lockstep_participant.h>
#include <ros/ros.h>
#include <std_msgs/String.h>

#include <cstdio>
#include <string>

namespace lockstep_exact {

namespace lockstep = move_base_abstract::lockstep;

namespace {

class Script {
 public:
  void run() {
    tell("first grant");
    sleepsAndTimers();
    rate();
    topics();
    sleepInCallback();
    errors();
    participant_.leave("done");
  }

 private:
  void tell(const std::string& what) {
    const ros::Time now = participant_.now();
    std::printf("%llu %u %s%s\n", static_cast<unsigned long long>(now.toNSec()),
                participant_.microstep(), what.c_str(),
                ros::Time::now() == now ? "" : " (ros::Time differs)");
  }

  lockstep::Timer timer(double period, const std::string& what, bool oneshot = false) {
    return participant_.createTimer(
        ros::Duration(period), [this, what](const ros::TimerEvent&) { tell(what); }, oneshot);
  }

  lockstep::Subscriber listen(const std::string& topic, const std::string& who, unsigned size = 0) {
    return participant_.subscribe<std_msgs::String>(
        topic,
        [this, who](const std_msgs::String& message) { tell(who + " gets " + message.data); },
        size);
  }

  static std_msgs::String text(const std::string& data) {
    std_msgs::String message;
    message.data = data;
    return message;
  }

  void sleepsAndTimers() {
    const auto half = timer(0.5, "half");
    const auto quarter = timer(0.25, "quarter");
    const auto once = timer(0.5, "once", true);
    auto none = timer(0.1, "stopped");
    none.stop();
    participant_.sleep(ros::Duration(0.5));
    tell("slept");
    participant_.sleepUntil(ros::Time(1.75));
    tell("slept until");
    participant_.sleep(ros::Duration(-1));
    participant_.sleep(ros::Duration(0));
    tell("slept not");
    const auto at_once = timer(0.0, "at once", true);
    participant_.spinOnce();
    tell("gave way");
  }

  void rate() {
    lockstep::Rate rate(participant_, ros::Duration(0, 333333333));
    for (int i = 0; i < 3; ++i) {
      rate.sleep();
      tell("rate");
    }
    participant_.sleep(ros::Duration(0.5));
    tell(rate.sleep() ? "rate in time" : "rate is late");
    rate.sleep();
    tell("rate");
  }

  void topics() {
    const auto out = participant_.advertise<std_msgs::String>("loop");
    const auto kept = participant_.advertise<std_msgs::String>("kept", true);
    const auto in = listen("loop", "in");
    const auto newest = listen("loop", "newest", 2);
    kept.publish(text("k1"));
    kept.publish(text("k2"));
    for (const char* data : {"a", "b", "c"}) {
      out.publish(text(data));
    }
    participant_.sleep(ros::Duration(0.5));
    const auto late = listen("kept", "late");
    participant_.sleep(ros::Duration(0.5));
    const auto later = listen("kept", "later");
    kept.publish(text("k3"));
    participant_.sleep(ros::Duration(0.5));
    tell(std::to_string(kept.getNumSubscribers()) + " subscriber");
  }

  void sleepInCallback() {
    const auto out = participant_.advertise<std_msgs::String>("slow");
    const auto in = participant_.subscribe<std_msgs::String>(
        "slow", [this](const std_msgs::String::ConstPtr& message) {
          tell("begins " + message->data);
          participant_.sleep(ros::Duration(0.5));
          tell("ends " + message->data);
        });
    const auto tick = timer(0.2, "tick");
    out.publish(text("one"));
    out.publish(text("two"));
    participant_.sleep(ros::Duration(0.3));
    tell("slept too long");
    participant_.sleep(ros::Duration(0.2));
    tell("slept");
  }

  template <class Action>
  void refused(const std::string& what, Action action) {
    try {
      action();
      tell(what + " was not refused");
    } catch (const lockstep::Error& error) {
      tell(what + ": " + error.what());
    }
  }

  void errors() {
    refused("timer", [this] { timer(0.0, "never"); });
    refused("second", [] { lockstep::Participant again; });
    refused("spin", [this] {
      const auto at_once = participant_.createTimer(
          ros::Duration(0), [this](const ros::TimerEvent&) { participant_.spin(); }, true);
      participant_.spinOnce();
    });
    tell(participant_.spinUntil([] { return false; }, ros::Duration(1.0)) ? "done" : "timed out");
  }

  lockstep::Participant participant_;
};

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "lockstep_exact");
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  try {
    Script().run();
  } catch (const lockstep::NotLockstep& error) {
    std::printf("%s\n", error.what());
    return 3;
  }
  return 0;
}

}  // namespace lockstep_exact
