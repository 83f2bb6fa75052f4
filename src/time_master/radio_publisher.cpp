#include "radio_publisher.h"

#include <move_base_abstract/RadioLinks.h>
#include <ros/node_handle.h>

#include "time_mode.h"

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kLinksGap = kNanosecondsPerSecond / 10;  // wall

geometry_msgs::Point pointOf(const radio::Place& place) {
  geometry_msgs::Point point;
  point.x = place.x;
  point.y = place.y;
  return point;
}

RadioLink messageOf(const LinkState& link) {
  RadioLink message;
  message.one = link.one;
  message.other = link.other;
  message.up = link.is_up;
  message.arrived = link.arrived;
  message.lost = link.lost;
  message.placed = link.has_places;
  message.one_at = pointOf(link.from);
  message.other_at = pointOf(link.to);
  return message;
}

}  // namespace

void RadioPublisher::work(LockstepServer& server, Nanoseconds wall) {
  if (wall < due_) {
    return;
  }
  std::vector<LinkState> links;
  RadioLinks message;
  server.with([&](LockstepSession& session) {
    links = session.takeLinks();
    message.stamp = toRos(session.now());
  });
  if (links.empty()) {
    return;
  }
  due_ = wall + kLinksGap;
  for (const LinkState& link : links) {
    message.links.push_back(messageOf(link));
  }
  if (!publisher_) {
    publisher_ = ros::NodeHandle("/time_master").advertise<RadioLinks>("links", 1, true);
  }
  publisher_.publish(message);
}

}  // namespace move_base_abstract
