#include "scaled_mode.h"

#include <ros/console.h>
#include <rosgraph_msgs/Clock.h>

#include <stdexcept>

namespace move_base_abstract {
namespace {

void log(const TimeMaster::Event& event) {
  switch (event.kind) {
    case TimeMaster::Event::Kind::kHoldExpired:
      ROS_WARN("hold by '%s' timed out at %s and was released; did its holder die?",
               event.holder.c_str(), text(event.time).c_str());
      break;
    case TimeMaster::Event::Kind::kTargetReached:
      ROS_DEBUG("reached %s, paused", text(event.time).c_str());
      break;
    case TimeMaster::Event::Kind::kGap:
      ROS_WARN(
          "the time master did not run for a while (it was stopped, or the computer is "
          "overloaded): simulated time stood at %s for %.3f s of wall time, and goes on from "
          "there; the parameter longest_gap says how much of such a gap counts",
          text(event.time).c_str(), static_cast<double>(event.left_out) / 1e9);
      break;
    case TimeMaster::Event::Kind::kEndOfTime:
      ROS_ERROR("simulated time is at its end, %s, and stands still: restart all nodes",
                text(event.time).c_str());
      break;
  }
}

}  // namespace

ScaledMode::ScaledMode(const TimeMaster::Settings& settings, const ros::Publisher& clock)
    : master_(settings, wallNow()), clock_(clock) {}

bool ScaledMode::work() {
  if (const auto time = master_.poll(wallNow())) {
    rosgraph_msgs::Clock message;
    message.clock = toRos(*time);
    clock_.publish(message);
  }
  const std::vector<TimeMaster::Event> events = master_.takeEvents();
  for (const TimeMaster::Event& event : events) {
    log(event);
  }
  return !events.empty();
}

void ScaledMode::describe(TimeState& state) {
  master_.advance(wallNow());
  state.paused = master_.paused();
  state.sim_time = toRos(master_.now());
  state.wanted_factor = master_.wantedFactor();
  state.effective_factor = master_.effectiveFactor();
  state.achieved_factor = master_.achievedFactor();
  state.busy_factor = master_.busyFactor();
  state.run_until = toRos(master_.target().value_or(0));
  for (const TimeMaster::Hold& held : master_.holds()) {
    Hold hold;
    hold.holder = held.holder;
    hold.remaining = static_cast<double>(held.remaining) / 1e9;
    state.holds.push_back(hold);
  }
}

std::string ScaledMode::inUse() const { return master_.holds().empty() ? "" : holders(); }

std::string ScaledMode::setFactor(double factor) {
  master_.setFactor(factor, wallNow());
  const std::string done = "factor is " + text(master_.wantedFactor());
  ROS_INFO("%s, from %s on", done.c_str(), text(master_.now()).c_str());
  return done;
}

std::string ScaledMode::pause() {
  master_.pause(wallNow());
  return "paused at " + text(master_.now());
}

std::string ScaledMode::resume() {
  master_.resume(wallNow());
  return "running from " + text(master_.now()) + " on";
}

std::string ScaledMode::hold(const std::string& holder, double timeout) {
  master_.hold(holder, timeout, wallNow());
  return "'" + holder + "' holds; factor is " + text(master_.effectiveFactor());
}

std::string ScaledMode::release(const std::string& holder) {
  if (!master_.release(holder, wallNow())) {
    throw std::invalid_argument("release: '" + holder +
                                "' does not hold (released before, timed out, or never held); " +
                                holders());
  }
  return "'" + holder + "' released; " + holders();
}

std::string ScaledMode::holders() const {
  std::vector<std::string> names;
  for (const TimeMaster::Hold& hold : master_.holds()) {
    names.push_back(hold.holder);
  }
  return names.empty() ? "nobody holds" : "holders are: " + joined(names);
}

}  // namespace move_base_abstract
