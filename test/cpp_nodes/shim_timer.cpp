// ros::Timer of all kinds: two periods that meet, a one-shot timer that starts another one, and a
// timer that a message stops and starts. Each publishes on "fired", with expected and real time.
#include <ros/ros.h>
#include <std_msgs/Empty.h>
#include <std_msgs/String.h>

#include <sstream>
#include <string>

namespace shim_timer {

class Timers {
 public:
  Timers() {
    publisher_ = node_.advertise<std_msgs::String>("fired", 100);
    fast_ = node_.createTimer(ros::Duration(0.1), &Timers::onFast, this);
    slow_ = node_.createTimer(ros::Duration(0.3), &Timers::onSlow, this);
    once_ = node_.createTimer(ros::Duration(1.05), &Timers::onOnce, this, true);
    subscriber_ = node_.subscribe("toggle", 1, &Timers::onToggle, this);
  }

 private:
  void tell(const std::string& name, const ros::TimerEvent& event) {
    std::ostringstream text;
    text << name << " expected " << event.current_expected << " real " << event.current_real
         << " last " << event.last_real;
    std_msgs::String message;
    message.data = text.str();
    publisher_.publish(message);
  }
  void onFast(const ros::TimerEvent& event) { tell("fast", event); }
  void onSlow(const ros::TimerEvent& event) { tell("slow", event); }
  void onOnce(const ros::TimerEvent& event) {
    tell("once", event);
    again_ = node_.createTimer(ros::Duration(2), &Timers::onAgain, this);
  }
  void onAgain(const ros::TimerEvent& event) { tell("again", event); }
  void onToggle(const std_msgs::Empty&) {
    if (is_on_) {
      fast_.stop();
    } else {
      fast_.start();
    }
    is_on_ = !is_on_;
  }

  ros::NodeHandle node_;
  bool is_on_ = true;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
  ros::Timer fast_, slow_, once_, again_;
};

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "timers");
  Timers timers;
  ros::spin();
  return 0;
}

}  // namespace shim_timer
