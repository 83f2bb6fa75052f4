#include "node.h"

#include <ros/init.h>
#include <ros/names.h>
#include <ros/param.h>
#include <ros/this_node.h>
#include <ros/time.h>
#include <ros/xmlrpc_manager.h>

#include <chrono>
#include <cstdlib>
#include <random>
#include <regex>
#include <stdexcept>

#include "exchange.h"
#include "participant/secret_parameter.h"
#include "real.h"

namespace move_base_abstract::shim {
namespace {

using Lock = std::lock_guard<PlainMutex>;
using lockstep::internal::Link;

constexpr int kPollMilliseconds = 100;             // wall; how soon an end of ROS is noticed
constexpr double kRetrySeconds = 0.05;             // wall
constexpr double kWarningSeconds = 10;             // wall
constexpr std::int64_t kPatience = 1'000'000'000;  // steady ns
const char* const kModeParameter = "/time_master/mode";
const char* const kAddressParameter = "/time_master/lockstep_address";
const char* const kRankVariable = "MOVE_BASE_ABSTRACT_LOCKSTEP_RANK";
const char* const kSleepVariable = "MOVE_BASE_ABSTRACT_LOCKSTEP_SLEEP";

std::int64_t steadyNow() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

std::string secretOrExit() {
  try {
    return secretOfRun();
  } catch (const std::invalid_argument& error) {
    ROS_FATAL("lockstep: parameter /time_master/%s", error.what());
    std::exit(1);
  }
}

void setRosTime(Nanoseconds now) {
  using SetNow = void(const ros::Time&);
  static SetNow* const set_now = real<SetNow>("_ZN3ros4Time6setNowERKS0_");
  set_now(ros::Time().fromNSec(static_cast<std::uint64_t>(now)));
}

}  // namespace

Node& node() {
  static Node* const instance = new Node;  // threads use it until the process has gone
  return *instance;
}

bool takesPart() { return turn().isActive(); }

Node::Node() {
  const char* const sleep = std::getenv(kSleepVariable);
  sleeps_simulated_ = sleep != nullptr && std::string(sleep) == "simulated";
}

bool Node::isWanted() {
  std::string mode;
  return ros::param::get(kModeParameter, mode) && mode == "lockstep";
}

// ---- joining and leaving ---------------------------------------------------------------------

bool Node::join() {
  name_ = ros::this_node::getName();
  readRank();
  readExcludedTopics();
  if (!connect()) {
    return false;
  }
  sayHello();
  is_joined_ = true;
  if (!ros::param::param("/use_sim_time", false)) {
    ROS_WARN("lockstep: %s takes part, but /use_sim_time is not true", name_.c_str());
  }
  if (!rank_declared_ && std::regex_search(name_, std::regex("_[0-9]{19}$"))) {
    label("the name " + name_ +
          " is made of a time, so its place among equal events differs from run to run; give it "
          "~lockstep_rank or a name");
  }
  awaitGrant();
  return !is_over_;
}

void Node::readRank() {
  XmlRpc::XmlRpcValue value;
  const std::string parameter = ros::names::resolve("~lockstep_rank");
  if (const char* const rank = std::getenv(kRankVariable)) {
    rank_ = std::atoi(rank);
    rank_declared_ = true;
  } else if (ros::param::get(parameter, value)) {
    if (value.getType() != XmlRpc::XmlRpcValue::TypeInt) {
      ROS_FATAL("lockstep: parameter %s: got %s; allowed: a whole number", parameter.c_str(),
                value.toXml().c_str());
      std::exit(1);
    }
    rank_ = static_cast<int>(value);
    rank_declared_ = true;
  }
}

bool Node::connect() {
  auto warn_at = ros::WallTime::now() + ros::WallDuration(kWarningSeconds);
  while (ros::ok() && !ros::isShuttingDown()) {
    std::string address;
    if (ros::param::get(kAddressParameter, address) && link_.connect(address)) {
      return true;
    }
    if (ros::WallTime::now() > warn_at) {
      ROS_WARN("lockstep: %s waits for the time master (%s is %s)", name_.c_str(),
               kAddressParameter,
               address.empty() ? "not set" : (address + ", where nobody listens").c_str());
      warn_at += ros::WallDuration(kWarningSeconds);
    }
    ros::WallDuration(kRetrySeconds).sleep();
  }
  return false;
}

void Node::sayHello() {
  std::random_device random;
  const std::string secret = secretOrExit();
  const std::string& uri = ros::XMLRPCManager::instance()->getServerURI();
  wire::Hello hello;
  hello.name = name_;
  hello.secret = secret;
  hello.node_uri = uri;
  hello.rank = rank_;
  hello.rank_declared = rank_declared_;
  hello.incarnation = (static_cast<std::uint64_t>(random()) << 32) | random();
  if (!link_.send(wire::encode(wire::ParticipantFrame(hello)))) {
    end("the time master has closed the connection");
  }
}

void Node::leave(const std::string& reason) {
  if (!is_joined_) {
    return;
  }
  // While another thread reads from the connection, that one closes it.
  const bool is_own = turn().holds();
  {
    const Lock lock(mutex_);
    if (is_over_) {
      return;
    }
    if (is_granted_) {
      wire::Report head;
      head.round = round_;
      head.leaving = true;
      link_.send(wire::encodeReport(head, items_));
    } else {
      link_.send(wire::encode(wire::ParticipantFrame(wire::Leave{reason})));
    }
    is_granted_ = false;
    is_over_ = true;  // not before all is sent: who reads from the connection closes it then
  }
  turn().end();
  bell_->ring();
  if (is_own) {
    link_.finish();
  }
}

void Node::end(const std::string& reason) {
  if (is_over_.exchange(true)) {
    return;
  }
  turn().end();
  link_.close();
  if (ros::ok()) {
    ROS_INFO("lockstep: the run is over for %s: %s", name_.c_str(), reason.c_str());
    ros::requestShutdown();
  }
}

// ---- rounds ----------------------------------------------------------------------------------

void Node::exchange() {
  const Inside inside;
  if (is_granted_) {
    report();
  }
  awaitGrant();
}

void Node::report() {
  wire::Report head;
  head.round = round_;
  head.next_ns = turn().nextWake();
  if (has_timers_) {
    head.next_ns = std::min(head.next_ns, timers_.next());
  }
  head.open = static_cast<std::uint32_t>(open_.size());
  tellWaits(head.next_ns == kNever);
  bool is_sent = true;
  {
    const Lock lock(mutex_);
    if (!is_over_) {
      is_sent = link_.send(wire::encodeReport(head, items_));
      items_.clear();
      is_granted_ = false;
    }
  }
  if (!is_sent) {
    end("the time master has closed the connection");
  }
}

void Node::tellWaits(bool is_endless) {
  std::string waits;
  for (const std::string& what : open_) {
    waits += (waits.empty() ? name_ + " waits for " : ", ") + what;
  }
  waits = is_endless ? waits : "";
  if (waits != told_) {
    told_ = waits;
    append(wire::Note{wire::NoteKind::kWaitsFor, waits});
  }
}

void Node::awaitGrant() {
  while (!is_over_ && !is_granted_) {
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
        if (!ros::ok() || ros::isShuttingDown()) {
          leave("ROS was shut down");
        } else if (enterOutside(true)) {
          // Without a grant: a caller may keep time standing until it has its answer, and what is
          // not urgent must not wait for ever.
          return;
        }
    }
  }
  if (is_over_) {
    link_.finish();
  }
}

void Node::knockIfNeeded() {
  bool has_input = turn().hasGuest();
  const Lock lock(mutex_);
  has_input = has_input || std::any_of(outside_.begin(), outside_.end(),
                                       [](const Input& input) { return input.is_urgent; });
  if (has_input && !has_knocked_ && !is_granted_ && !is_over_ && round_ > 0) {
    has_knocked_ = true;
    link_.send(wire::encode(wire::ParticipantFrame(wire::Knock{})));
  }
}

void Node::readFrames() {
  frames_.append(received_);
  received_.clear();
  try {
    for (auto frame = frames_.next(); frame && !is_over_; frame = frames_.next()) {
      std::visit([this](const auto& decoded) { handle(decoded); }, wire::decodeFromMaster(*frame));
    }
  } catch (const wire::MalformedFrame& error) {
    ROS_ERROR("lockstep: %s got a bad frame from the time master: %s", name_.c_str(), error.what());
    end("the time master sent a bad frame");
  }
}

void Node::handle(const wire::Welcome& frame) {
  const Lock lock(mutex_);
  members_[frame.own_id] = {name_, ros::XMLRPCManager::instance()->getServerURI()};
}

void Node::handle(const wire::Member& frame) {
  {
    const Lock lock(mutex_);
    members_[frame.id] = {std::string(frame.name), std::string(frame.node_uri)};
  }
  dropConnectionsTo(std::string(frame.name));
}

void Node::handle(const wire::Gone& frame) {
  const Lock lock(mutex_);
  members_.erase(frame.id);
}

void Node::handle(const wire::Grant& frame) {
  {
    const Lock lock(mutex_);
    round_ = frame.round;
    now_ = frame.time_ns;
    is_granted_ = true;
    has_knocked_ = false;
  }
  setRosTime(now_);
  for (const wire::GrantItem& item : frame.items) {
    std::visit([](const auto& decoded) { shim::handle(decoded); }, item);
  }
  enterOutside(false);
  if (has_timers_) {
    timers_.fire();
  }
}

void Node::handle(const wire::End& frame) { end(std::string(frame.reason)); }

// ---- what others use -------------------------------------------------------------------------

void Node::append(const wire::ReportItem& item) {
  const Lock lock(mutex_);
  if (!is_over_) {
    wire::append(items_, item);
  }
}

void Node::label(const std::string& reason) {
  const Lock lock(mutex_);
  if (!is_over_ && labels_.insert(reason).second) {
    wire::append(items_, wire::Note{wire::NoteKind::kNotRepeatable, reason});
  }
}

void Node::fromOutside(Input input) {
  {
    const Lock lock(mutex_);
    if (outside_since_ == 0) {
      outside_since_ = steadyNow();
    }
    outside_.push_back(std::move(input));
  }
  bell_->ring();
}

bool Node::enterOutside(bool only_if_late) {
  std::deque<Input> inputs;
  {
    const Lock lock(mutex_);
    if (only_if_late && (outside_since_ == 0 || steadyNow() - outside_since_ < kPatience)) {
      return false;
    }
    inputs.swap(outside_);
    outside_since_ = 0;
  }
  for (Input& input : inputs) {
    if (!input.label.empty()) {
      label(input.label);
    }
    input.enter();
  }
  return true;
}

void Node::removeOutside(const ros::CallbackQueue* queue, std::uint64_t owner) {
  const Lock lock(mutex_);
  outside_.erase(std::remove_if(outside_.begin(), outside_.end(),
                                [queue, owner](const Input& input) {
                                  return input.queue == queue && input.owner == owner;
                                }),
                 outside_.end());
}

void Node::setTimers(SimulatedTimers timers) {
  timers_ = std::move(timers);
  has_timers_ = true;
}

bool Node::isMember(const std::string& name) {
  const Lock lock(mutex_);
  return std::any_of(members_.begin(), members_.end(),
                     [&name](const auto& member) { return member.second.first == name; });
}

bool Node::isMemberAt(const std::string& uri) {
  const Lock lock(mutex_);
  return std::any_of(members_.begin(), members_.end(),
                     [&uri](const auto& member) { return member.second.second == uri; });
}

std::string Node::nameOf(std::uint32_t member) {
  const Lock lock(mutex_);
  const auto found = members_.find(member);
  return found == members_.end() ? std::string() : found->second.first;
}

std::string Node::uriOf(std::uint32_t member) {
  const Lock lock(mutex_);
  const auto found = members_.find(member);
  return found == members_.end() ? std::string() : found->second.second;
}

}  // namespace move_base_abstract::shim
