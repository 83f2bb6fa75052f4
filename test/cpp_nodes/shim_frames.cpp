// tf2: it sends one frame at 20 Hz. With ~look it asks a TransformListener (with its own thread)
// for the frame, with time-outs, too early and at the right time, and publishes results on
// "looked". With ~listen it only listens. With ~filter it publishes when points get their
// transform. With ~arrive it begins to listen then [s], and looks at that instant, after a call of
// the service ~ask, if there is one.
#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <message_filters/subscriber.h>
#include <nav_msgs/Odometry.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_srvs/Empty.h>
#include <tf2_ros/message_filter.h>
#include <tf2_ros/transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>

#include <cstdio>
#include <string>

#include "teller.h"

namespace shim_frames {

namespace {

void send(ros::NodeHandle& node) {
  tf2_ros::TransformBroadcaster broadcaster;
  const boost::function<void(const ros::TimerEvent&)> tick = [&](const ros::TimerEvent& event) {
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = event.current_real;
    transform.header.frame_id = "map";
    transform.child_frame_id = "robot";
    transform.transform.translation.x = event.current_real.toSec();
    transform.transform.rotation.w = 1;
    broadcaster.sendTransform(transform);
  };
  const ros::Timer timer = node.createTimer(ros::Duration(0.05), tick);
  ros::spin();
}

void look() {
  const Teller teller("looked");
  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer);
  ros::Rate rate(2);
  for (int k = 0; k < 20; ++k) {
    rate.sleep();
    const std::string begin = std::to_string(ros::Time::now().toNSec()) + " ";
    std::string found = "no transform";
    try {
      const auto ahead = ros::Duration(k % 4 == 3 ? 0.12 : 0.0);
      const auto transform = buffer.lookupTransform("map", k == 10 ? "nothing" : "robot",
                                                    ros::Time::now() + ahead, ros::Duration(0.3));
      found = std::to_string(transform.transform.translation.x);
    } catch (const tf2::TransformException&) {
    }
    teller.say(begin + found + " at " + std::to_string(ros::Time::now().toNSec()));
  }
  ros::NodeHandle("~").setParam("done", true);
}

void listen() {
  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer);
  ros::spin();
}

void arrive(ros::NodeHandle& node, double seconds) {
  (ros::Time(seconds) - ros::Time::now()).sleep();
  const boost::function<void(const nav_msgs::OdometryConstPtr&)> hear =
      [](const nav_msgs::OdometryConstPtr& odom) {
        std::printf("= cpp odom %.9f %.9f %u %.9f\n", ros::Time::now().toSec(),
                    odom->header.stamp.toSec(), odom->header.seq, odom->pose.pose.position.x);
      };
  const ros::Subscriber subscriber = node.subscribe<nav_msgs::Odometry>("odom", 10, hear);
  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer);
  const std::string service = ros::NodeHandle("~").param<std::string>("ask", "");
  std_srvs::Empty empty;
  if (!service.empty() && !ros::service::call(service, empty)) {
    std::printf("cpp: no answer\n");
  }
  const auto found = buffer.lookupTransform("odom", "base_link", ros::Time::now());
  std::printf("= cpp tf %.9f %.9f %.9f\n", ros::Time::now().toSec(), found.header.stamp.toSec(),
              found.transform.translation.x);
  ros::spinOnce();
  std::fflush(stdout);
}

/** A point every 0.33 s, in the robot's frame: off the instants of the transforms. Ends after 20.
 */
void filter(ros::NodeHandle& node) {
  int count = 0;
  const Teller teller("looked");
  ros::Publisher points = node.advertise<geometry_msgs::PointStamped>("points", 100);
  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer);
  message_filters::Subscriber<geometry_msgs::PointStamped> subscriber(node, "points", 100);
  tf2_ros::MessageFilter<geometry_msgs::PointStamped> waiting(subscriber, buffer, "map", 100, node);
  waiting.registerCallback(boost::function<void(const geometry_msgs::PointStampedConstPtr&)>(
      [&](const geometry_msgs::PointStampedConstPtr& point) {
        teller.say(std::to_string(point->header.stamp.toNSec()) + " came out at " +
                   std::to_string(ros::Time::now().toNSec()));
        ++count;
      }));
  const boost::function<void(const ros::TimerEvent&)> tick = [&](const ros::TimerEvent& event) {
    geometry_msgs::PointStamped point;
    point.header.stamp = event.current_real;
    point.header.frame_id = "robot";
    points.publish(point);
  };
  const ros::Timer timer = node.createTimer(ros::Duration(0.33), tick);
  while (ros::ok() && count < 20) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  }
  ros::NodeHandle("~").setParam("done", true);
}

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "frames");
  ros::NodeHandle node;
  const double arrival = ros::NodeHandle("~").param("arrive", 0.0);
  if (arrival > 0.0) {
    arrive(node, arrival);
  } else if (ros::NodeHandle("~").param("look", false)) {
    look();
  } else if (ros::NodeHandle("~").param("listen", false)) {
    listen();
  } else if (ros::NodeHandle("~").param("filter", false)) {
    filter(node);
  } else {
    send(node);
  }
  return 0;
}

}  // namespace shim_frames
