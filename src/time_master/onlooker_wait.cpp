#include "onlooker_wait.h"

#include <ros/console.h>

#include "clock/shown_text.h"
#include "node_probe.h"

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kOnlookerGap = kNanosecondsPerSecond / 10;  // wall, between two looks
constexpr Nanoseconds kOnlookerQuiet = kNanosecondsPerSecond;     // wall
constexpr int kOnlookerLimit = 5;                                 // s, wall
constexpr std::chrono::milliseconds kOnlookerAnswer{1000};        // wall
constexpr int kServicePlace = 2;  // their place in the answer to getSystemState

}  // namespace

void OnlookerWait::begin(LockstepServer& server, const std::vector<std::string>& names) {
  missing_.insert(names.begin(), names.end());
  is_over_ = names.empty();
  if (!is_over_) {
    hold(server, shown(joined(names)));
  }
}

/** @brief Let time stand, and say for what. */
void OnlookerWait::hold(LockstepServer& server, const std::string& what) {
  const std::string text =
      "nodes that look on are waited for, at most " + std::to_string(kOnlookerLimit) +
      " s of wall time: " + (what.empty() ? "what they have sent may be under way" : what);
  server.with([&](LockstepSession& session) { session.holdForOthers(text); });
}

void OnlookerWait::work(LockstepServer& server, Nanoseconds wall) {
  if (is_over_) {
    return;
  }
  wall = server.with([&](LockstepSession& session) { return session.limitsNow(wall); });
  if (wall < due_) {
    return;
  }
  due_ = wall + kOnlookerGap;
  const auto [wanted, rounds] = server.with(
      [](LockstepSession& session) { return std::make_pair(session.wanted(), session.rounds()); });
  if (!wanted) {
    return;  // participants still work at the first instant
  }
  std::string why;
  if (wanted->is_any) {
    if (limit_ == kNever) {
      limit_ = wall + kOnlookerLimit * kNanosecondsPerSecond;
      ROS_INFO(
          "lockstep: time stands until nodes that look on are there, at most %d s of wall time",
          kOnlookerLimit);
    }
    if (look() || rounds != rounds_) {
      changed_ = wall;
      rounds_ = rounds;
    }
    const std::string what = missing(wanted->services);
    if (wall < limit_ && (!what.empty() || wall < changed_ + kOnlookerQuiet)) {
      hold(server, what);
      return;
    }
    if (!what.empty()) {
      why = "time has started without " + what + ", after " + std::to_string(kOnlookerLimit) +
            " s of wall time: an onlooker is late, or waits itself";
    }
  }
  is_over_ = true;
  server.with([&](LockstepSession& session) { session.release(why); });
}

/** @brief Ask the ROS master who is there. @return whether anything has changed. */
bool OnlookerWait::look() {
  XmlRpc::XmlRpcValue request, state;
  request[0] = ros::this_node::getName();
  if (!masterProbe().call("getSystemState", request, kOnlookerAnswer, state) ||
      state.getType() != XmlRpc::XmlRpcValue::TypeArray || state.size() <= kServicePlace) {
    return true;
  }
  for (int kind = 0; kind <= kServicePlace; ++kind) {
    for (int one = 0; one < state[kind].size(); ++one) {
      XmlRpc::XmlRpcValue& nodes = state[kind][one][1];
      for (int node = 0; node < nodes.size(); ++node) {
        missing_.erase(static_cast<std::string>(nodes[node]));
      }
      if (kind == kServicePlace) {
        services_.insert(static_cast<std::string>(state[kind][one][0]));
      }
    }
  }
  return std::exchange(seen_, state.toXml()) != seen_;
}

/** @return in words the nodes, or the services of @p services, that are not there yet; or ''. */
std::string OnlookerWait::missing(const std::vector<std::string>& services) const {
  std::vector<std::string> found(missing_.begin(), missing_.end());
  for (const std::string& one : services) {
    if (services_.count(one) == 0) {
      found.push_back("the service " + one);
    }
  }
  return shown(joined(found));
}

}  // namespace move_base_abstract
