// Notices nodes that listened to /clock and died, on the scaled clock, which does not wait for
// them.
#pragma once

#include <ros/master.h>
#include <ros/network.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "clock/shown_text.h"
#include "node_probe.h"

namespace move_base_abstract {

/**
 * @brief Watches the nodes that listen to /clock. A node that stops listening has ended or died. If
 * it ended, it has unregistered from the ROS master. If it was killed or crashed, it has not, and
 * it no longer answers.
 */
class ClockListeners {
 public:
  /** @return the latched publisher of /clock. This object must outlive it. */
  ros::Publisher advertise(ros::NodeHandle& node) {
    const auto nothing = [](const ros::SingleSubscriberPublisher&) {};
    const auto note = [this](const ros::SingleSubscriberPublisher& link) {
      left_.push_back({link.getSubscriberName(), WallClock::now() + kPatience});
    };
    return node.advertise<rosgraph_msgs::Clock>("/clock", 10, nothing, note, ros::VoidConstPtr(),
                                                true);
  }

  /**
   * @brief Look for deaths. @param at the present instant, as a text. @return whether there is a
   * new one.
   */
  bool update(const std::string& at) {
    const std::size_t known = died_.size();
    while (!left_.empty() && left_.front().due <= WallClock::now()) {
      const std::string name = std::exchange(left_.front().name, "");
      left_.erase(left_.begin());
      if (died_.size() < kMost && hasDied(name)) {
        died_.push_back("'" + shown(name) + "' died (found at " + at + ")");
        ROS_ERROR("%s: it does not answer any more, and has not unregistered from the ROS master",
                  died_.back().c_str());
      }
    }
    return died_.size() != known;
  }

  /** @brief Forget the nodes that have gone, because the session watches them in lockstep. */
  void forget() { left_.clear(); }

  /** @return the texts of all deaths. */
  const std::vector<std::string>& died() const { return died_; }

 private:
  struct Left {
    std::string name;
    WallClock::time_point due;
  };

  static constexpr std::chrono::milliseconds kPatience{500};  // wall, for a node to unregister
  static constexpr std::chrono::milliseconds kLimit{200};     // wall, for an answer
  static constexpr std::size_t kMost = 100;

  static bool hasDied(const std::string& name) {
    XmlRpc::XmlRpcValue request, response, uri;
    request[0] = ros::this_node::getName();
    request[1] = name;
    std::string host;
    uint32_t port = 0;
    return ros::master::execute("lookupNode", request, response, uri, false) &&
           ros::network::splitURI(static_cast<std::string>(uri), host, port) &&
           !NodeProbe(host, static_cast<int>(port)).answers(kLimit);
  }

  std::vector<Left> left_;
  std::vector<std::string> died_;
};

}  // namespace move_base_abstract
