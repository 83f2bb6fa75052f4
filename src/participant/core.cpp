// Rounds: the connection, reports and grants, and what runs in between.
#include "core.h"

#include <XmlRpc.h>
#include <ros/callback_queue.h>
#include <ros/network.h>
#include <ros/ros.h>
#include <ros/topic_manager.h>
#include <ros/xmlrpc_manager.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <random>
#include <regex>
#include <stdexcept>

#include "secret_parameter.h"

namespace ros {
CallbackQueuePtr getInternalCallbackQueue();  // exported by roscpp, but in none of its headers
}

namespace move_base_abstract::lockstep::internal {
namespace {

constexpr int kPollMilliseconds = 100;  // wall; how soon an end of ROS is noticed
constexpr double kRetrySeconds = 0.05;  // wall
constexpr double kWarningSeconds = 10;  // wall
const char* const kModeParameter = "/time_master/mode";
const char* const kAddressParameter = "/time_master/lockstep_address";

std::atomic<bool> exists{false};  // two cores would both set ros::Time

/** @brief Runs in roscpp's internal queue behind whatever /clock has put there. */
class Marker : public ros::CallbackInterface {
 public:
  CallResult call() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_passed_ = true;
    passed_.notify_all();
    return Success;
  }
  void wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    passed_.wait_for(lock, std::chrono::seconds(5), [this] { return is_passed_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable passed_;
  bool is_passed_ = false;
};

/** @brief Tell roscpp, by the slave API as a ROS master does, that nobody publishes @p topic. */
bool endConnections(const std::string& topic) {
  const std::string& uri = ros::XMLRPCManager::instance()->getServerURI();
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(uri, host, port)) {
    return false;
  }
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue request, response;
  request[0] = ros::this_node::getName();
  request[1] = topic;
  request[2].setSize(0);
  return client.execute("publisherUpdate", request, response) && !client.isFault();
}

/** @brief Take /clock from roscpp: it may be ahead of this node's grants or behind them. */
void detachFromClock() {
  const std::string clock = ros::names::resolve("/clock");
  ros::V_string subscribed;
  ros::TopicManager::instance()->getSubscribedTopics(subscribed);
  if (std::find(subscribed.begin(), subscribed.end(), clock) == subscribed.end()) {
    return;
  }
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = ros::this_node::getName();
  request[1] = clock;
  request[2] = ros::XMLRPCManager::instance()->getServerURI();
  if (!ros::master::execute("unregisterSubscriber", request, response, payload, false) ||
      !endConnections(clock)) {
    throw Error("lockstep: node " + ros::this_node::getName() + " could not be taken off " + clock);
  }
  const auto marker = boost::make_shared<Marker>();
  ros::getInternalCallbackQueue()->addCallback(marker);
  marker->wait();
}

std::uint64_t newIncarnation() {
  std::random_device random;
  return (static_cast<std::uint64_t>(random()) << 32) | random();
}

}  // namespace

Core::Core(const Options& options) : name_(ros::this_node::getName()) {
  if (exists) {
    throw Error("lockstep: node " + name_ +
                " has a Participant already; one per process is allowed");
  }
  readParameters(options);
  exists = true;
}

void Core::readParameters(const Options& options) {
  XmlRpc::XmlRpcValue value;
  if (options.rank) {
    rank_ = *options.rank;
  } else if (private_node_.getParam("lockstep_rank", value)) {
    if (value.getType() != XmlRpc::XmlRpcValue::TypeInt) {
      throw Error("lockstep: parameter " + private_node_.resolveName("lockstep_rank") + ": got " +
                  value.toXml() + "; allowed: a whole number");
    }
    rank_ = static_cast<int>(value);
  }
  rank_declared_ = options.rank || value.valid();
  std::string charge = "none";
  if (private_node_.getParam("lockstep_charge", charge) && charge != "none") {
    throw Error("lockstep: parameter " + private_node_.resolveName("lockstep_charge") + ": got '" +
                charge + "'; allowed in a roscpp node: 'none'");
  }
  std::vector<std::string> excluded;
  ros::param::get("/time_master/excluded_topics", excluded);
  for (const std::string& topic : excluded) {
    excluded_.insert(ros::names::resolve(topic));
  }
}

Core::~Core() { exists = false; }

// ---- joining and leaving ---------------------------------------------------------------------

void Core::join() {
  connectToTimeMaster();
  detachFromClock();
  sayHello();
  if (!ros::param::param("/use_sim_time", false)) {
    ROS_WARN("lockstep: %s takes part, but /use_sim_time is not true", name_.c_str());
  }
  if (!rank_declared_ && std::regex_search(name_, std::regex("_[0-9]{19}$"))) {
    label("the name " + name_ +
          " is made of a time, so its place among equal events differs from run " +
          "to run; give it ~lockstep_rank or a name");
  }
  awaitGrant();
  if (state_ != State::kTurn) {
    throw Error("lockstep: node " + name_ + " did not get to its first grant: " + end_reason_);
  }
}

void Core::connectToTimeMaster() {
  ros::WallTime warn_at = ros::WallTime::now() + ros::WallDuration(kWarningSeconds);
  while (ros::ok()) {
    std::string mode, address;
    if (ros::param::get(kModeParameter, mode) && mode != "lockstep") {
      throw NotLockstep("lockstep: node " + name_ +
                        " takes part in lockstep, but the time master's " + kModeParameter +
                        " is '" + mode + "', not 'lockstep'");
    }
    if (ros::param::get(kAddressParameter, address) && link_.connect(address)) {
      return;
    }
    if (ros::WallTime::now() > warn_at) {
      ROS_WARN("lockstep: %s waits for the time master (%s is %s)", name_.c_str(),
               kAddressParameter,
               address.empty() ? "not set" : (address + ", where nobody listens").c_str());
      warn_at += ros::WallDuration(kWarningSeconds);
    }
    ros::WallDuration(kRetrySeconds).sleep();
  }
  throw Error("lockstep: node " + name_ + ": ROS was shut down before the time master was there");
}

void Core::sayHello() {
  std::string secret;
  try {
    secret = secretOfRun();
  } catch (const std::invalid_argument& error) {
    throw Error("lockstep: node " + name_ + ": parameter /time_master/" + error.what());
  }
  wire::Hello hello;
  hello.secret = secret;
  const std::string& uri = ros::XMLRPCManager::instance()->getServerURI();
  hello.name = name_;
  hello.node_uri = uri;
  hello.rank = rank_;
  hello.rank_declared = rank_declared_;
  hello.incarnation = newIncarnation();
  if (!link_.send(wire::encode(wire::ParticipantFrame(hello)))) {
    end("the time master has closed the connection");
  }
}

void Core::leave(const std::string& reason) {
  if (state_ == State::kTurn) {
    if (!reason.empty()) {
      ROS_INFO("lockstep: %s leaves: %s", name_.c_str(), reason.c_str());
    }
    report(kNever, true);
  } else if (state_ == State::kReported || state_ == State::kJoining) {
    link_.send(wire::encode(wire::ParticipantFrame(wire::Leave{reason})));
  }
  if (isActive() || state_ == State::kJoining) {
    state_ = State::kLeft;
    end_reason_ = "it has left";
  }
  link_.finish();
  mail_.clear();
  outside_.clear();
}

void Core::end(const std::string& reason) {
  if (state_ == State::kLeft || state_ == State::kOver) {
    return;
  }
  state_ = State::kOver;
  end_reason_ = reason;
  link_.close();
  mail_.clear();
  outside_.clear();
  if (ros::ok()) {
    ROS_INFO("lockstep: the run is over for %s: %s", name_.c_str(), reason.c_str());
    ros::shutdown();
  }
}

void Core::endIfRosHas() {
  if (!ros::ok() && (isActive() || state_ == State::kJoining)) {
    leave("ROS was shut down");
    state_ = State::kOver;
    end_reason_ = "ROS was shut down";
  }
}

void Core::check(const char* what) const {
  if (std::this_thread::get_id() != thread_) {
    throw Error("lockstep: " + std::string(what) + " of " + name_ +
                " was called from another thread; only the one that made the Participant may");
  }
  if (state_ == State::kLeft) {
    throw Error("lockstep: " + std::string(what) + " of " + name_ +
                " was called after it has left");
  }
}

void Core::checkOutsideCallback(const char* what) const {
  check(what);
  if (is_in_callback_) {
    throw Error("lockstep: " + std::string(what) + " of " + name_ +
                " was called in a callback; only sleep and service calls may");
  }
}

// ---- rounds ----------------------------------------------------------------------------------

Core::Woken Core::wait(Nanoseconds until, Callbacks callbacks, const std::function<bool()>& done,
                       const std::string& what) {
  const bool runs = callbacks == Callbacks::kRun && !is_in_callback_;
  while (true) {
    if (runs) {
      runCallbacks();
    }
    if (done && done()) {
      return Woken::kDone;
    }
    endIfRosHas();
    if (!isActive()) {
      return Woken::kOver;
    }
    if (now_ >= until) {
      return Woken::kTime;
    }
    waits_for_ = until == kNever ? what : "";
    report(nextDue(until, runs ? Callbacks::kRun : Callbacks::kWait), false);
    awaitGrant();
  }
}

bool Core::giveWay() {
  runCallbacks();
  if (isActive()) {
    waits_for_.clear();
    report(now_, false);
    awaitGrant();
    runCallbacks();
  }
  return isActive();
}

void Core::report(Nanoseconds next, bool leaving) {
  if (waits_for_ != told_) {
    append(wire::Note{wire::NoteKind::kWaitsFor, waits_for_});
    told_ = waits_for_;
  }
  wire::Report head;
  head.round = round_;
  head.leaving = leaving;
  head.next_ns = next;
  head.open = waits_for_.empty() ? 0 : 1;
  const bool is_sent = link_.send(wire::encodeReport(head, items_));
  items_.clear();
  state_ = State::kReported;
  if (!is_sent) {
    end("the time master has closed the connection");
  }
}

void Core::awaitGrant() {
  while (state_ == State::kReported || state_ == State::kJoining) {
    takeOutside();
    knockIfNeeded();
    switch (link_.wait(*bell_, kPollMilliseconds, &received_)) {
      case Link::Event::kBytes:
        readFrames();
        break;
      case Link::Event::kBell:
        bell_->silence();
        break;
      case Link::Event::kClosed:
        end("the time master has closed the connection");
        break;
      case Link::Event::kNothing:
        endIfRosHas();
    }
  }
}

void Core::readFrames() {
  frames_.append(received_);
  received_.clear();
  try {
    for (auto frame = frames_.next(); frame && state_ != State::kOver; frame = frames_.next()) {
      std::visit([this](const auto& decoded) { handle(decoded); }, wire::decodeFromMaster(*frame));
    }
  } catch (const wire::MalformedFrame& error) {
    ROS_ERROR("lockstep: %s got a bad frame from the time master: %s", name_.c_str(), error.what());
    end("the time master sent a bad frame");
  }
}

void Core::handle(const wire::Welcome& frame) { members_[frame.own_id] = name_; }

void Core::handle(const wire::Member& frame) {
  members_[frame.id] = frame.name;
  member_names_.insert(std::string(frame.name));
}

void Core::handle(const wire::Gone& frame) {
  takeOutside();  // what the member sent before it went is judged while it is one
  const auto found = members_.find(frame.id);
  if (found != members_.end()) {
    member_names_.erase(member_names_.find(found->second));
    members_.erase(found);
  }
}

void Core::handle(const wire::Grant& frame) {
  round_ = frame.round;
  now_ = frame.time_ns;
  microstep_ = frame.microstep;
  state_ = State::kTurn;
  has_knocked_ = false;
  ros::Time::setNow(ros::Time().fromNSec(static_cast<std::uint64_t>(now_)));
  for (const wire::GrantItem& item : frame.items) {
    std::visit([this](const auto& decoded) { handle(decoded); }, item);
  }
  takeOutside();
  enterOutside();
}

void Core::handle(const wire::End& frame) { end(std::string(frame.reason)); }

// ---- callbacks -------------------------------------------------------------------------------

void Core::runCallbacks() {
  while (isActive()) {
    if (!mail_.empty()) {
      const auto callback = std::move(mail_.front());
      mail_.pop_front();
      runOne(callback);
    } else if (TimerState* const timer = dueTimer()) {
      const auto guard = timer->shared_from_this();  // the callback may drop the last handle
      runOne([&guard] { guard->fire(); });
    } else {
      return;
    }
  }
}

void Core::runOne(const std::function<void()>& callback) {
  struct Guard {
    explicit Guard(bool* entered) : flag(entered) { *flag = true; }
    ~Guard() { *flag = false; }
    bool* flag;
  };
  const Guard guard(&is_in_callback_);
  callback();
}

TimerState* Core::dueTimer() const {
  if (timers_.empty() || timers_.begin()->first.first > now_) {
    return nullptr;
  }
  return timers_.begin()->second;
}

Nanoseconds Core::nextDue(Nanoseconds until, Callbacks callbacks) const {
  if (callbacks == Callbacks::kWait || timers_.empty()) {
    return until;
  }
  return std::min(until, timers_.begin()->first.first);
}

void Core::schedule(TimerState& timer) { timers_[{timer.due_, timer.number_}] = &timer; }
void Core::unschedule(TimerState& timer) { timers_.erase({timer.due_, timer.number_}); }

TimerState::TimerState(const std::shared_ptr<Core>& core, Nanoseconds period, Callback callback,
                       bool oneshot)
    : core_(core),
      number_(core->nextTimerNumber()),
      period_(period),
      oneshot_(oneshot),
      callback_(std::move(callback)) {}

TimerState::~TimerState() { stop(); }

void TimerState::start() {
  const auto core = core_.lock();
  if (core && !is_running_) {
    last_due_ = core->now();
    last_fired_ = core->now();
    due_ = core->now() + period_;
    is_running_ = true;
    core->schedule(*this);
  }
}

void TimerState::stop() {
  const auto core = core_.lock();
  if (core && is_running_) {
    core->unschedule(*this);
  }
  is_running_ = false;
}

void TimerState::fire() {
  const auto core = core_.lock();
  core->unschedule(*this);
  const auto toRos = [](Nanoseconds time) {
    return ros::Time().fromNSec(static_cast<std::uint64_t>(time));
  };
  ros::TimerEvent event;
  event.last_expected = toRos(last_due_);
  event.last_real = toRos(last_fired_);
  event.current_expected = toRos(due_);
  event.current_real = toRos(core->now());
  last_due_ = due_;
  last_fired_ = core->now();
  if (oneshot_) {
    is_running_ = false;
  } else {
    // Before the callback, which may stop the timer. What a sleeping callback missed is one call.
    due_ += std::max<Nanoseconds>((core->now() - due_) / period_, 0) * period_ + period_;
    core->schedule(*this);
  }
  const Callback callback = callback_;
  callback(event);
}

}  // namespace move_base_abstract::lockstep::internal
