// Callbacks and ros::spin: it answers each message of "ticks" on "heard" with the time and the
// text. With ~work [s] the callback sleeps for that long, as if it drove something.
#include <ros/ros.h>
#include <std_msgs/String.h>

#include <string>

namespace shim_listener {

class Listener {
 public:
  Listener() {
    ros::NodeHandle("~").param("work", work_, work_);
    publisher_ = node_.advertise<std_msgs::String>("heard", 10);
    subscriber_ = node_.subscribe("ticks", 10, &Listener::onTick, this);
  }

 private:
  void onTick(const std_msgs::String::ConstPtr& message) {
    if (work_ > 0) {
      ros::Duration(work_).sleep();
    }
    std_msgs::String answer;
    answer.data = std::to_string(ros::Time::now().toNSec()) + " heard " + message->data;
    publisher_.publish(answer);
  }

  ros::NodeHandle node_;
  double work_ = 0;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
};

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "listener");
  Listener listener;
  ros::spin();
  return 0;
}

}  // namespace shim_listener
