// Notices other nodes that publish /clock, before and while the time master does.
#pragma once

#include <ros/callback_queue.h>
#include <ros/network.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "clock/shown_text.h"
#include "node_probe.h"

namespace move_base_abstract {

/** @return whether a living node already has this node's name. Call this before ros::start(). */
inline bool ownNameIsTaken() {
  XmlRpc::XmlRpcValue request, response, uri;
  request[0] = ros::this_node::getName();
  request[1] = ros::this_node::getName();
  if (!ros::master::execute("lookupNode", request, response, uri, false)) {
    return false;
  }
  std::string host;
  uint32_t port = 0;
  return ros::network::splitURI(static_cast<std::string>(uri), host, port) &&
         NodeProbe(host, static_cast<int>(port)).answers(std::chrono::seconds(1));
}

/**
 * @brief Listens to /clock, and remembers for a while which other nodes publish it.
 *
 * All messages, also those of its own node, wait in a queue of its own until update(), so that they
 * do not wake a thread each.
 */
class ClockWatch {
 public:
  explicit ClockWatch(ros::NodeHandle node) {
    node.setCallbackQueue(&queue_);
    subscriber_ = node.subscribe("/clock", 100, &ClockWatch::onClock, this);
  }

  /** @return the nodes heard in the last seconds, in alphabetical order. */
  std::vector<std::string> heard() const {
    std::vector<std::string> names;
    for (const auto& other : others_) {
      names.push_back(other.first);
    }
    return names;
  }

  /**
   * @brief Read the messages, and forget the nodes that are silent. @return whether heard() has
   * changed.
   */
  bool update() {
    queue_.callAvailable();
    const auto now = WallClock::now();
    for (auto other = others_.begin(); other != others_.end();) {
      if (now - other->second.heard > kMemory) {
        ROS_INFO("%s no longer publishes /clock", shown(other->first).c_str());
        other = others_.erase(other);
        changed_ = true;
      } else {
        ++other;
      }
    }
    const bool changed = changed_;
    changed_ = false;
    return changed;
  }

  /**
   * @brief Wait up to @p limit [wall] for a message of another node. @return the nodes that were
   * heard.
   */
  std::vector<std::string> listen(std::chrono::milliseconds limit) {
    const auto deadline = WallClock::now() + limit;
    while (ros::ok() && others_.empty() && WallClock::now() < deadline) {
      queue_.callAvailable(ros::WallDuration(0.05));
    }
    return heard();
  }

  /** @return the other nodes that the ROS master lists as publishers of /clock. */
  static std::vector<std::string> listed() {
    XmlRpc::XmlRpcValue request, response, state;
    std::vector<std::string> names;
    request[0] = ros::this_node::getName();
    if (!ros::master::execute("getSystemState", request, response, state, false)) {
      return names;
    }
    XmlRpc::XmlRpcValue& topics = state[0];
    for (int topic = 0; topic < topics.size(); ++topic) {
      if (static_cast<std::string>(topics[topic][0]) != "/clock") {
        continue;
      }
      for (int node = 0; node < topics[topic][1].size(); ++node) {
        names.push_back(static_cast<std::string>(topics[topic][1][node]));
      }
    }
    return names;
  }

 private:
  struct Other {
    WallClock::time_point heard;
    WallClock::time_point logged;
  };

  static constexpr std::chrono::seconds kMemory{3};
  static constexpr std::chrono::seconds kLogGap{10};

  void onClock(const ros::MessageEvent<rosgraph_msgs::Clock const>& event) {
    const std::string& name = event.getPublisherName();
    if (name == ros::this_node::getName()) {
      return;
    }
    const auto now = WallClock::now();
    const auto [other, is_new] = others_.try_emplace(name, Other{now, now - 2 * kLogGap});
    other->second.heard = now;
    changed_ = changed_ || is_new;
    // By the wall clock, because a throttle in ROS time would depend on the clock that is in doubt.
    if (now - other->second.logged > kLogGap) {
      other->second.logged = now;
      ROS_ERROR("%s publishes /clock too (%.9f s): time will jump; stop it, or this time master",
                shown(name).c_str(), event.getMessage()->clock.toSec());
    }
  }

  std::map<std::string, Other> others_;
  bool changed_ = false;
  ros::CallbackQueue queue_;
  ros::Subscriber subscriber_;
};

}  // namespace move_base_abstract
