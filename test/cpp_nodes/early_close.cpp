// Sells eight tasks by auction; each auction is open for 0.2 s. ~correct: without the bug.
// The bug: if a bid comes after its auction has closed, it looks it up among the open auctions.
#include <geometry_msgs/Point.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/Int32.h>

#include <map>

namespace early_close {

namespace {

/** Handle what comes, for so long [s]. */
void spinFor(double duration) {
  bool is_over = false;
  const ros::Timer timer = ros::NodeHandle().createTimer(
      ros::Duration(duration), [&](const ros::TimerEvent&) { is_over = true; }, true);
  while (!is_over && ros::ok()) {
    ros::getGlobalCallbackQueue()->callOne(ros::WallDuration(1.0));
  }
}

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "coordinator");
  ros::NodeHandle node;
  const bool correct = ros::NodeHandle("~").param("correct", false);
  std::map<int, std::map<double, int>> open;  // bidders by price, for each auction
  const auto auctions = node.advertise<std_msgs::Int32>("auctions", 10);
  const auto bids = node.subscribe<geometry_msgs::Point>(
      "bids", 10, [&](const geometry_msgs::Point::ConstPtr& bid) {
        const int auction = static_cast<int>(bid->x);
        if (!correct || open.count(auction) > 0) {
          open.at(auction)[bid->z] = static_cast<int>(bid->y);
        }
      });
  for (int number = 1; number <= 8; ++number) {
    spinFor(5.0);
    std_msgs::Int32 auction;
    auction.data = number;
    open[number];
    auctions.publish(auction);
    spinFor(0.2);
    open.erase(number);
  }
  spinFor(5.0);
  return 0;
}

}  // namespace early_close
