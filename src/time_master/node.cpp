// The ROS side of the time master: services, the state topic and the change of mode, in one thread.
#include <move_base_abstract/AcquireHold.h>
#include <move_base_abstract/ReleaseHold.h>
#include <move_base_abstract/RunUntil.h>
#include <move_base_abstract/SetFactor.h>
#include <move_base_abstract/SetMode.h>
#include <move_base_abstract/Step.h>
#include <move_base_abstract/TimeState.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <std_msgs/Float64.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "clock/shown_text.h"
#include "clock_listeners.h"
#include "clock_watch.h"
#include "debugger_services.h"
#include "lockstep_mode.h"
#include "master_call_guard.h"
#include "own_address.h"
#include "parameters/parameters.h"
#include "ros_master_watch.h"
#include "scaled_mode.h"

namespace move_base_abstract {
namespace {

constexpr const char* kUsage =
    "usage: time_master [_PARAMETER:=VALUE ...] [NAME:=VALUE ...]\n\n"
    "Publishes /clock: simulated time at a factor of the wall's (_factor:=10), or event by event\n"
    "(_mode:=lockstep). It is configured by private parameters; docs/time_master.md lists them.";

bool asksForHelp(const char* word) {
  return std::string_view(word) == "--help" || std::string_view(word) == "-h";
}

constexpr Nanoseconds kLongestWait = kNanosecondsPerSecond / 10;  // so that a signal is seen soon

std::atomic<int> signal_number{0};

/** @return the path of the event log of the @p run th run: a.jsonl, a_2.jsonl, ... */
std::string numbered(const std::string& path, int run) {
  const std::size_t dot = path.rfind('.');
  return run == 1 || dot == std::string::npos
             ? path
             : path.substr(0, dot) + "_" + std::to_string(run) + path.substr(dot);
}

}  // namespace

class TimeMasterNode {
 public:
  TimeMasterNode(ros::NodeHandle node, ros::NodeHandle own, const NodeParameters& parameters,
                 ClockWatch& watch)
      : watch_(watch),
        parameters_(parameters),
        state_gap_(static_cast<Nanoseconds>(1e9 / parameters.state_rate)),
        debugger_services_(
            own, [this] { return mode_->lockstep(); }, [this] { changed_ = true; }) {
    // Left by a run that was killed; participants would take it for the address of this run.
    ros::param::del("/time_master/lockstep_address");
    clock_publisher_ = listeners_.advertise(node);
    state_publisher_ = own.advertise<TimeState>("state", 10, true);
    factor_subscriber_ = node.subscribe("/sim_time_factor", 10, &TimeMasterNode::onFactor, this);
    services_ = {own.advertiseService("set_factor", &TimeMasterNode::onSetFactor, this),
                 own.advertiseService("set_mode", &TimeMasterNode::onSetMode, this),
                 own.advertiseService("pause", &TimeMasterNode::onPause, this),
                 own.advertiseService("resume", &TimeMasterNode::onResume, this),
                 own.advertiseService("step", &TimeMasterNode::onStep, this),
                 own.advertiseService("run_until", &TimeMasterNode::onRunUntil, this),
                 own.advertiseService("hold", &TimeMasterNode::onHold, this),
                 own.advertiseService("release", &TimeMasterNode::onRelease, this)};
  }

  /**
   * @brief Publish and answer until ROS shuts down or the run ends. @return the exit code.
   * @throws std::invalid_argument if a parameter is wrong; the text begins with its key.
   * @throws std::runtime_error if the time master cannot work.
   */
  int run() {
    begin(parameters_.in_lockstep, 0);
    while (ros::ok() && signal_number == 0 && !mode_->ended()) {
      changed_ = mode_->work() || changed_;
      watchListeners();
      publishState();
      const Nanoseconds due = std::min(mode_->nextWork(), state_due_);
      const Nanoseconds wait = std::clamp<Nanoseconds>(due - wallNow(), 0, kLongestWait);
      ros::getGlobalCallbackQueue()->callAvailable(
          ros::WallDuration(0, static_cast<int32_t>(wait)));
    }
    return finish();
  }

 private:
  int finish() {
    const std::optional<TimeMode::End> end = mode_->ended();
    const bool kept = mode_->finish(end ? end->reason : "the time master was told to end");
    if (!end) {
      return kept ? 0 : 1;
    }
    if (end->good) {
      ROS_INFO("the run is over: %s", end->reason.c_str());
    } else {
      ROS_FATAL("the run is over: %s", end->reason.c_str());
    }
    state_publisher_.publish(state());
    return end->good && kept ? 0 : 1;
  }

  /** @brief Start a mode at @p time [ns, simulated]; 0: at the parameter start_time. */
  void begin(bool in_lockstep, Nanoseconds time) {
    setParameter("/time_master/mode", in_lockstep ? "lockstep" : "scaled");
    if (in_lockstep) {
      NodeParameters parameters = parameters_;
      parameters.event_log = numbered(parameters_.event_log, ++runs_);
      mode_ = std::make_unique<LockstepMode>(parameters, clock_publisher_, time);
    } else {
      TimeMaster::Settings settings = parameters_.master;
      if (time > 0) {
        settings.start_time = secondsNotBefore(time);
      }
      mode_ = std::make_unique<ScaledMode>(settings, clock_publisher_);
    }
  }

  /**
   * @brief Look for dead listeners of /clock, except in lockstep, where the session notices deaths.
   */
  void watchListeners() {
    if (mode_->name() == std::string_view("lockstep")) {
      listeners_.forget();
    } else {
      changed_ = listeners_.update(text(mode_->now())) || changed_;
    }
  }

  void publishState() {
    changed_ = watch_.update() || changed_;
    const Nanoseconds wall = wallNow();
    if (!changed_ && wall < state_due_) {
      return;
    }
    state_publisher_.publish(state());
    changed_ = false;
    state_due_ = wall + state_gap_;
  }

  TimeState state() {
    TimeState state;
    state.mode = mode_->name();
    mode_->describe(state);
    state.other_clock_publishers = watch_.heard();
    state.degraded_because.insert(state.degraded_because.end(), listeners_.died().begin(),
                                  listeners_.died().end());
    return state;
  }

  /**
   * @brief Take the factor that an existing study sets. In lockstep it must not slow the run down
   * unless a parameter says so.
   */
  void onFactor(const ros::MessageEvent<std_msgs::Float64 const>& event) {
    if (mode_->name() == std::string_view("lockstep") && !parameters_.sim_time_factor_is_limit) {
      ROS_INFO_ONCE(
          "/sim_time_factor from %s has no effect in lockstep, which goes as fast as it can; the "
          "parameter sim_time_factor_is_limit makes it a speed limit (shown once)",
          shown(event.getPublisherName()).c_str());
      return;
    }
    try {
      mode_->setFactor(event.getMessage()->data);
      changed_ = true;
    } catch (const std::invalid_argument& error) {
      ROS_WARN("/sim_time_factor from %s refused: %s", shown(event.getPublisherName()).c_str(),
               error.what());
    }
  }

  /** @brief Answer a service with the text that @p action returns, or with its refusal. */
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
      ROS_WARN("service %s refused: %s", service, shown(error.what()).c_str());
    }
    return true;
  }

  bool onSetFactor(SetFactor::Request& request, SetFactor::Response& response) {
    return answer("set_factor", response, [&] { return mode_->setFactor(request.factor); });
  }

  bool onSetMode(SetMode::Request& request, SetMode::Response& response) {
    return answer("set_mode", response, [&] { return setMode(request.mode); });
  }

  std::string setMode(const std::string& wanted) {
    if (wanted != "scaled" && wanted != "lockstep") {
      throw std::invalid_argument("mode must be scaled or lockstep, got '" + wanted + "'");
    }
    if (wanted == mode_->name()) {
      return "the mode is " + wanted + " already";
    }
    const std::string in_use = mode_->inUse();
    if (!in_use.empty()) {
      throw std::invalid_argument("mode must not be changed from " + std::string(mode_->name()) +
                                  " to " + wanted + " while it is in use: " + in_use);
    }
    mode_->finish("the mode is changed to " + wanted);
    const std::string before = mode_->name();
    try {
      begin(wanted == "lockstep", mode_->now());
    } catch (const std::exception& error) {
      begin(before == "lockstep", mode_->now());
      throw std::invalid_argument("mode cannot be changed to " + wanted + ": " + error.what());
    }
    ROS_INFO("the mode is %s from %s on", wanted.c_str(), text(mode_->now()).c_str());
    return "the mode is " + wanted + " from " + text(mode_->now()) + " on";
  }

  bool onPause(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    return answer("pause", response, [&] { return mode_->pause(); });
  }

  bool onResume(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    return answer("resume", response, [&] { return mode_->resume(); });
  }

  bool onStep(Step::Request& request, Step::Response& response) {
    return answer("step", response, [&] {
      const Nanoseconds target = mode_->step(fromRos(request.duration));
      response.target = toRos(target);
      return "running until " + text(target);
    });
  }

  bool onRunUntil(RunUntil::Request& request, RunUntil::Response& response) {
    return answer("run_until", response, [&] {
      mode_->runUntil(fromRos(request.target));
      return "running until " + text(fromRos(request.target));
    });
  }

  bool onHold(AcquireHold::Request& request, AcquireHold::Response& response) {
    return answer("hold", response, [&] { return mode_->hold(request.holder, request.timeout); });
  }

  bool onRelease(ReleaseHold::Request& request, ReleaseHold::Response& response) {
    return answer("release", response, [&] { return mode_->release(request.holder); });
  }

  ClockWatch& watch_;
  const NodeParameters parameters_;
  const Nanoseconds state_gap_;
  Nanoseconds state_due_ = 0;
  int runs_ = 0;  // in lockstep
  bool changed_ = false;
  ClockListeners listeners_;
  ros::Publisher clock_publisher_;
  ros::Publisher state_publisher_;
  std::unique_ptr<TimeMode> mode_;
  ros::Subscriber factor_subscriber_;
  std::vector<ros::ServiceServer> services_;
  DebuggerServices debugger_services_;
};

namespace {

/** @brief Look for a living publisher of /clock. @return whether the clock is free. */
bool clockIsFree(ClockWatch& watch) {
  const std::vector<std::string> listed = ClockWatch::listed();
  if (listed.empty()) {
    return true;
  }
  for (const std::string& name : watch.listen(std::chrono::seconds(1))) {
    ROS_FATAL("%s publishes /clock already: two would make time jump; stop it first",
              shown(name).c_str());
    return false;
  }
  for (const std::string& name : listed) {
    ROS_WARN("%s is listed as a publisher of /clock but is silent; going on", shown(name).c_str());
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

void announce(const NodeParameters& parameters) {
  const std::string start = text(parameters.master.start_time);
  const char* paused = parameters.master.start_paused ? ", paused" : "";
  if (parameters.in_lockstep) {
    const std::string named = parameters.lockstep.participants.empty()
                                  ? "the first participants"
                                  : joined(parameters.lockstep.participants);
    ROS_INFO("simulated time starts at %s s, in lockstep, when there are: %s%s", start.c_str(),
             named.c_str(), paused);
  } else {
    ROS_INFO("simulated time starts at %s s, factor %s%s", start.c_str(),
             text(parameters.master.factor).c_str(), paused);
  }
}

/** @return the node; null if another node publishes the clock. */
std::unique_ptr<TimeMasterNode> makeNode(ros::NodeHandle& node, const ros::NodeHandle& own,
                                         ClockWatch& watch) {
  const NodeParameters parameters = readParameters(own);
  warnUnlessSimTime();
  if (!clockIsFree(watch)) {
    return nullptr;
  }
  auto master = std::make_unique<TimeMasterNode>(node, own, parameters, watch);
  announce(parameters);
  return master;
}

int runNode(MasterCallGuard& guard) {
  std::optional<MasterCallGuard::Section> calls(std::in_place, guard);
  if (ownNameIsTaken()) {
    ROS_FATAL("a time master runs already as %s: a second one would set time back; stop it first",
              ros::this_node::getName().c_str());
    return 1;
  }
  ros::NodeHandle node;
  ros::NodeHandle own("~");
  ClockWatch watch(node);
  std::unique_ptr<TimeMasterNode> master;
  int code = 1;
  try {
    master = makeNode(node, own, watch);
    calls.reset();  // from here on an event log could be lost, and calls have limits
    code = master ? master->run() : 1;
  } catch (const std::invalid_argument& error) {
    ROS_FATAL("parameter %s/%s", own.getNamespace().c_str(), shown(error.what()).c_str());
  } catch (const std::runtime_error& error) {
    ROS_FATAL("%s", shown(error.what()).c_str());
  }
  calls.emplace(guard);  // for the calls of the destructors
  return code;
}

}  // namespace
}  // namespace move_base_abstract

int main(int argc, char** argv) {
  if (std::any_of(argv + 1, argv + argc, move_base_abstract::asksForHelp)) {
    std::puts(move_base_abstract::kUsage);  // before it looks for a ROS master
    return 0;
  }
  std::setvbuf(stdout, nullptr, _IOLBF,
               BUFSIZ);  // output appears at once, also through a pipe
  move_base_abstract::setDefaultAddress();
  ros::init(argc, argv, "time_master", ros::init_options::NoSigintHandler);
  if (argc > 1) {  // arguments that ROS has not taken
    std::fprintf(stderr, "time_master: unknown argument %s; see --help\n",
                 move_base_abstract::shown(argv[1]).c_str());
    return 2;
  }
  // Participants are told of the end, and it is written down, before ROS shuts down.
  for (const int number : {SIGINT, SIGTERM}) {
    std::signal(number, [](int got) { move_base_abstract::signal_number = got; });
  }
  std::signal(SIGXFSZ, SIG_IGN);  // a file at its limit is an error like a full disk
  move_base_abstract::MasterCallGuard guard(move_base_abstract::signal_number);
  if (!guard.awaitMaster()) {
    return 0;
  }
  const int code = move_base_abstract::runNode(guard);
  const move_base_abstract::MasterCallGuard::Section section(guard);
  ros::shutdown();
  return code;
}
