// A user's node that knows nothing of a simulator: a loop at 1 Hz. usage: bench_rate TICKS
#include <ros/ros.h>

#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
  ros::init(argc, argv, "rate");
  ros::NodeHandle node;
  const int count = argc > 1 ? std::atoi(argv[1]) : 1000;
  ros::Rate rate(1.0);
  ros::Time last = ros::Time::now();
  int off = 0;
  std::puts("begin");
  std::fflush(stdout);
  for (int i = 0; i < count && ros::ok(); ++i) {
    ros::spinOnce();
    rate.sleep();
    off += (ros::Time::now() - last != ros::Duration(1.0)) ? 1 : 0;
    last = ros::Time::now();
  }
  std::printf("{\"count\": %d, \"off\": %d}\n", count, off);
  return 0;
}
