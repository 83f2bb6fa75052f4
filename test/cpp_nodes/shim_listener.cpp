// Callbacks and ros::spin: it answers each message of "ticks" on "heard" with the time and the
// text. With ~work [s] the callback sleeps for that long, as if it drove something. What begins
// with "error" is logged as one.
#include <ros/ros.h>
#include <std_msgs/String.h>

#include "teller.h"

namespace shim_listener {

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "listener");
  ros::NodeHandle node;
  const double work = ros::NodeHandle("~").param("work", 0.0);
  const Teller teller("heard");
  const auto subscriber =
      node.subscribe<std_msgs::String>("ticks", 10, [&](const std_msgs::String::ConstPtr& message) {
        if (work > 0) {
          ros::Duration(work).sleep();
        }
        if (message->data.rfind("error", 0) == 0) {
          ROS_ERROR("got the %s", message->data.c_str());
        }
        teller.tell("heard " + message->data);
      });
  ros::spin();
  return 0;
}

}  // namespace shim_listener
