// A coordinator with a bug, as users write one: it assumes that it always hears the first worker
// first.
#include <ros/ros.h>
#include <std_msgs/Int32.h>

#include <cstdlib>

namespace shim_order {

namespace {

int first = -1;

void hearFirst(const std_msgs::Int32::ConstPtr& done) { first = done->data; }

void hearSecond(const std_msgs::Int32::ConstPtr& done) {
  if (done->data != first) {
    ROS_ERROR("worker 2 is done with task %d, and worker 1 has done %d only", done->data, first);
    std::_Exit(3);
  }
}

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "coordinator");
  ros::NodeHandle node;
  const ros::Subscriber one = node.subscribe("/worker_1/done", 10, hearFirst);
  const ros::Subscriber two = node.subscribe("/worker_2/done", 10, hearSecond);
  ros::spin();
  return 0;
}

}  // namespace shim_order
