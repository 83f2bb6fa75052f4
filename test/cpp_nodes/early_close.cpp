// Sells eight tasks by auction; each auction is open for 0.2 s. ~correct: without the bug.
// The bug: if a bid comes after its auction has closed, it looks it up among the open auctions.
#include <geometry_msgs/Point.h>
#include <move_base_abstract/lockstep_participant.h>
#include <ros/ros.h>
#include <std_msgs/Int32.h>

#include <map>

namespace early_close {

namespace lockstep = move_base_abstract::lockstep;

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "coordinator");
  const bool correct = ros::NodeHandle("~").param("correct", false);
  lockstep::Participant participant;
  std::map<int, std::map<double, int>> open;  // bidders by price, for each auction
  const auto auctions = participant.advertise<std_msgs::Int32>("auctions");
  const auto bids =
      participant.subscribe<geometry_msgs::Point>("bids", [&](const geometry_msgs::Point& bid) {
        const int auction = static_cast<int>(bid.x);
        if (!correct || open.count(auction) > 0) {
          open.at(auction)[bid.z] = static_cast<int>(bid.y);
        }
      });
  for (int number = 1; number <= 8; ++number) {
    participant.sleep(ros::Duration(5.0));
    std_msgs::Int32 auction;
    auction.data = number;
    open[number];
    auctions.publish(auction);
    participant.sleep(ros::Duration(0.2));
    open.erase(number);
  }
  participant.sleep(ros::Duration(5.0));
  return 0;
}

}  // namespace early_close
