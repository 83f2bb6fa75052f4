// The time master's ROS side: parameters, /clock, services and the state topic, in one thread.
#include <move_base_abstract/AcquireHold.h>
#include <move_base_abstract/ReleaseHold.h>
#include <move_base_abstract/RunUntil.h>
#include <move_base_abstract/SetFactor.h>
#include <move_base_abstract/Step.h>
#include <move_base_abstract/TimeState.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <std_msgs/Float64.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <string>

#include "clock_watch.h"
#include "move_base_abstract/time_master.h"
#include "time_master_parameters.h"

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kLongestWait = kNanosecondsPerSecond / 10;  // so that SIGINT is seen soon

Nanoseconds wallNow() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(WallClock::now().time_since_epoch())
      .count();
}

ros::Time toRos(Nanoseconds time) {
  return ros::Time(static_cast<uint32_t>(time / kNanosecondsPerSecond),
                   static_cast<uint32_t>(time % kNanosecondsPerSecond));
}

/** @brief An instant or duration of ROS in ns; exact, also where it is negative. */
template <typename RosTime>
Nanoseconds fromRos(const RosTime& time) {
  return static_cast<Nanoseconds>(time.sec) * kNanosecondsPerSecond + time.nsec;
}

std::string text(Nanoseconds time) {
  char buffer[40];
  std::snprintf(buffer, sizeof(buffer), "%lld.%09lld s",
                static_cast<long long>(time / kNanosecondsPerSecond),
                static_cast<long long>(time % kNanosecondsPerSecond));
  return buffer;
}

std::string text(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof(buffer), "%.12g", value);
  return buffer;
}

}  // namespace

class TimeMasterNode {
 public:
  TimeMasterNode(ros::NodeHandle node, ros::NodeHandle own, const NodeParameters& parameters,
                 ClockWatch& watch)
      : watch_(watch),
        master_(parameters.master, wallNow()),
        state_gap_(static_cast<Nanoseconds>(1e9 / parameters.state_rate)) {
    clock_publisher_ = node.advertise<rosgraph_msgs::Clock>("/clock", 10, true);
    state_publisher_ = own.advertise<TimeState>("state", 10, true);
    factor_subscriber_ = node.subscribe("/sim_time_factor", 10, &TimeMasterNode::onFactor, this);
    services_ = {own.advertiseService("set_factor", &TimeMasterNode::onSetFactor, this),
                 own.advertiseService("pause", &TimeMasterNode::onPause, this),
                 own.advertiseService("resume", &TimeMasterNode::onResume, this),
                 own.advertiseService("step", &TimeMasterNode::onStep, this),
                 own.advertiseService("run_until", &TimeMasterNode::onRunUntil, this),
                 own.advertiseService("hold", &TimeMasterNode::onHold, this),
                 own.advertiseService("release", &TimeMasterNode::onRelease, this)};
  }

  /** @brief Publish and answer until ROS shuts down. */
  void run() {
    while (ros::ok()) {
      publishClock();
      logEvents();
      publishState();
      const Nanoseconds due = std::min(master_.nextWake(), state_due_);
      const Nanoseconds wait = std::clamp<Nanoseconds>(due - wallNow(), 0, kLongestWait);
      ros::getGlobalCallbackQueue()->callAvailable(
          ros::WallDuration(0, static_cast<int32_t>(wait)));
    }
  }

 private:
  void publishClock() {
    if (const auto time = master_.poll(wallNow())) {
      rosgraph_msgs::Clock message;
      message.clock = toRos(*time);
      clock_publisher_.publish(message);
    }
  }

  void logEvents() {
    for (const TimeMaster::Event& event : master_.takeEvents()) {
      changed_ = true;
      switch (event.kind) {
        case TimeMaster::Event::Kind::kHoldExpired:
          ROS_WARN("hold by '%s' timed out at %s and was released; did its holder die?",
                   event.holder.c_str(), text(event.time).c_str());
          break;
        case TimeMaster::Event::Kind::kTargetReached:
          ROS_DEBUG("reached %s, paused", text(event.time).c_str());
          break;
        case TimeMaster::Event::Kind::kEndOfTime:
          ROS_ERROR("simulated time is at its end, %s, and stands still: start all nodes anew",
                    text(event.time).c_str());
          break;
      }
    }
  }

  void publishState() {
    changed_ = watch_.update() || changed_;
    const Nanoseconds wall = wallNow();
    if (!changed_ && wall < state_due_) {
      return;
    }
    master_.advance(wall);
    state_publisher_.publish(state());
    changed_ = false;
    state_due_ = wall + state_gap_;
  }

  TimeState state() const {
    TimeState state;
    state.mode = "scaled";
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
    state.other_clock_publishers = watch_.heard();
    return state;
  }

  void onFactor(const ros::MessageEvent<std_msgs::Float64 const>& event) {
    try {
      setFactor(event.getMessage()->data);
    } catch (const std::invalid_argument& error) {
      ROS_WARN("/sim_time_factor from %s refused: %s", event.getPublisherName().c_str(),
               error.what());
    }
  }

  std::string setFactor(double factor) {
    master_.setFactor(factor, wallNow());
    changed_ = true;
    const std::string done = "factor is " + text(master_.wantedFactor());
    ROS_INFO("%s, from %s on", done.c_str(), text(master_.now()).c_str());
    return done;
  }

  /** @brief Do @p action, which returns what it did, and turn a refusal into the answer. */
  template <typename Response, typename Action>
  bool answer(const char* service, Response& response, Action action) {
    try {
      response.message = action();
      response.success = true;
      changed_ = true;
      ROS_DEBUG("%s: %s", service, response.message.c_str());
    } catch (const std::invalid_argument& error) {
      response.message = error.what();
      response.success = false;
      ROS_WARN("service %s refused: %s", service, error.what());
    }
    return true;
  }

  bool onSetFactor(SetFactor::Request& request, SetFactor::Response& response) {
    return answer("set_factor", response, [&] { return setFactor(request.factor); });
  }

  bool onPause(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    return answer("pause", response, [&] {
      master_.pause(wallNow());
      return "paused at " + text(master_.now());
    });
  }

  bool onResume(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    return answer("resume", response, [&] {
      master_.resume(wallNow());
      return "running from " + text(master_.now()) + " on";
    });
  }

  bool onStep(Step::Request& request, Step::Response& response) {
    return answer("step", response, [&] {
      const Nanoseconds target = master_.step(fromRos(request.duration), wallNow());
      response.target = toRos(target);
      return "running until " + text(target);
    });
  }

  bool onRunUntil(RunUntil::Request& request, RunUntil::Response& response) {
    return answer("run_until", response, [&] {
      master_.runUntil(fromRos(request.target), wallNow());
      return "running until " + text(fromRos(request.target));
    });
  }

  bool onHold(AcquireHold::Request& request, AcquireHold::Response& response) {
    return answer("hold", response, [&] {
      master_.hold(request.holder, request.timeout, wallNow());
      return "'" + request.holder + "' holds; factor is " + text(master_.effectiveFactor());
    });
  }

  bool onRelease(ReleaseHold::Request& request, ReleaseHold::Response& response) {
    return answer("release", response, [&] {
      if (!master_.release(request.holder, wallNow())) {
        throw std::invalid_argument(
            "release: '" + request.holder +
            "' does not hold (released before, timed out, or never held); " + holders());
      }
      return "'" + request.holder + "' released; " + holders();
    });
  }

  std::string holders() const {
    std::string names;
    for (const TimeMaster::Hold& hold : master_.holds()) {
      names += (names.empty() ? "holders are: " : ", ") + hold.holder;
    }
    return names.empty() ? "nobody holds" : names;
  }

  ClockWatch& watch_;
  TimeMaster master_;
  const Nanoseconds state_gap_;
  Nanoseconds state_due_ = 0;
  bool changed_ = false;
  ros::Publisher clock_publisher_;
  ros::Publisher state_publisher_;
  ros::Subscriber factor_subscriber_;
  std::vector<ros::ServiceServer> services_;
};

namespace {

/** @brief Look for a living publisher of /clock. @return whether the clock is free. */
bool clockIsFree(ClockWatch& watch) {
  const std::vector<std::string> listed = ClockWatch::listed();
  if (listed.empty()) {
    return true;
  }
  for (const std::string& name : watch.listen(std::chrono::seconds(1))) {
    ROS_FATAL("%s publishes /clock already: two would make time jump; stop it first", name.c_str());
    return false;
  }
  for (const std::string& name : listed) {
    ROS_WARN("%s is listed as a publisher of /clock but is silent; going on", name.c_str());
  }
  return true;
}

void warnUnlessSimTime() {
  bool use_sim_time = false;
  if (!ros::param::get("/use_sim_time", use_sim_time) || !use_sim_time) {
    ROS_WARN(
        "/use_sim_time is not true: nodes will ignore /clock; set it before they start, as "
        "time_master.launch does");
  }
}

int runNode() {
  if (ownNameIsTaken()) {
    ROS_FATAL("a time master runs already as %s: a second one would set time back; stop it first",
              ros::this_node::getName().c_str());
    return 1;
  }
  ros::NodeHandle node;
  ros::NodeHandle own("~");
  NodeParameters parameters;
  ClockWatch watch(node);
  try {
    parameters = readParameters(own);
    warnUnlessSimTime();
    if (!clockIsFree(watch)) {
      return 1;
    }
    TimeMasterNode master(node, own, parameters, watch);
    ROS_INFO("simulated time starts at %s s, factor %s%s",
             text(parameters.master.start_time).c_str(), text(parameters.master.factor).c_str(),
             parameters.master.start_paused ? ", paused" : "");
    master.run();
  } catch (const std::invalid_argument& error) {
    ROS_FATAL("parameter %s/%s", own.getNamespace().c_str(), error.what());
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace move_base_abstract

int main(int argc, char** argv) {
  ros::init(argc, argv, "time_master");
  std::signal(SIGTERM, [](int) { ros::requestShutdown(); });  // roscpp does so on SIGINT only
  const int code = move_base_abstract::runNode();
  ros::shutdown();
  return code;
}
