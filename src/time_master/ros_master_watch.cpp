#include "ros_master_watch.h"

#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "node_probe.h"

namespace move_base_abstract {
namespace {

constexpr std::chrono::milliseconds kWatchGap{1000};    // wall, between two looks
constexpr std::chrono::milliseconds kWatchLimit{2000};  // wall, for an answer
constexpr std::chrono::milliseconds kSetLimit{10000};   // wall, for an answer
constexpr std::chrono::milliseconds kProbeLimit{200};   // wall, for a node's port
constexpr int kLooksBetweenProbes = 5;
constexpr int kRefusals = 3;  // one refused connection may be an overflowing backlog

}  // namespace

RosMasterWatch::RosMasterWatch() : thread_([this] { run(); }) {}

RosMasterWatch::~RosMasterWatch() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

std::string RosMasterWatch::gone() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return gone_;
}

std::set<std::string> RosMasterWatch::clockSubscribers() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return subscribers_;
}

void RosMasterWatch::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!ending_ && gone_.empty()) {
    lock.unlock();
    look();
    lock.lock();
    wake_.wait_for(lock, kWatchGap, [this] { return ending_; });
  }
}

void RosMasterWatch::look() {
  if (!canConnect(ros::master::getHost(), ros::master::getPort(), kWatchLimit)) {
    if (++refusals_ >= kRefusals) {
      setGone("the ROS master at " + ros::master::getURI() + " no longer takes connections");
    }
    return;
  }
  refusals_ = 0;
  XmlRpc::XmlRpcValue request, pid;
  request[0] = ros::this_node::getName();
  if (masterProbe().call("getPid", request, kWatchLimit, pid) &&
      pid.getType() == XmlRpc::XmlRpcValue::TypeInt) {
    if (pid_ != 0 && static_cast<int>(pid) != pid_) {
      setGone("another ROS master answers at " + ros::master::getURI() +
              ": it knows none of the nodes");
      return;
    }
    pid_ = static_cast<int>(pid);
  }
  readSubscribers();
}

void RosMasterWatch::readSubscribers() {
  XmlRpc::XmlRpcValue request, state;
  request[0] = ros::this_node::getName();
  if (!masterProbe().call("getSystemState", request, kWatchLimit, state) ||
      state.getType() != XmlRpc::XmlRpcValue::TypeArray || state.size() < 2) {
    return;
  }
  std::set<std::string> names;
  XmlRpc::XmlRpcValue& topics = state[1];
  for (int topic = 0; topic < topics.size(); ++topic) {
    if (static_cast<std::string>(topics[topic][0]) != "/clock") {
      continue;
    }
    for (int node = 0; node < topics[topic][1].size(); ++node) {
      names.insert(static_cast<std::string>(topics[topic][1][node]));
    }
  }
  names.erase(ros::this_node::getName());
  std::set<std::string> living;
  std::copy_if(names.begin(), names.end(), std::inserter(living, living.end()),
               [this](const std::string& name) { return lives(name); });
  ++looks_;
  const std::lock_guard<std::mutex> lock(mutex_);
  subscribers_ = living;
  ++answers_;
}

/**
 * @brief Whether a node lives. The ROS master also lists nodes that were killed, so nodes are asked
 * from time to time.
 */
bool RosMasterWatch::lives(const std::string& name) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (known_.count(name) != 0) {
      lives_.erase(name);  // when it is not known any more, it is asked at once
      return true;
    }
  }
  const auto [found, fresh] = lives_.try_emplace(name, false);
  if (fresh || looks_ % kLooksBetweenProbes == 0) {
    XmlRpc::XmlRpcValue request, uri;
    request[0] = ros::this_node::getName();
    request[1] = name;
    std::string host;
    uint32_t port = 0;
    found->second = masterProbe().call("lookupNode", request, kWatchLimit, uri) &&
                    uri.getType() == XmlRpc::XmlRpcValue::TypeString &&
                    ros::network::splitURI(static_cast<std::string>(uri), host, port) &&
                    canConnect(host, port, kProbeLimit);
  }
  return found->second;
}

void RosMasterWatch::setKnown(std::set<std::string> names) {
  const std::lock_guard<std::mutex> lock(mutex_);
  known_ = std::move(names);
}

void RosMasterWatch::setGone(const std::string& why) {
  const std::lock_guard<std::mutex> lock(mutex_);
  gone_ = why;
}

void setParameter(const std::string& key, const std::string& value) {
  XmlRpc::XmlRpcValue request, result;
  request[0] = ros::this_node::getName();
  request[1] = key;
  request[2] = value;
  if (!masterProbe().call("setParam", request, kSetLimit, result)) {
    throw std::runtime_error("the ROS master at " + ros::master::getURI() +
                             " has not accepted the parameter " + key);
  }
}

void deleteParameter(const std::string& key) {
  XmlRpc::XmlRpcValue request, result;
  request[0] = ros::this_node::getName();
  request[1] = key;
  masterProbe().call("deleteParam", request, std::chrono::seconds(1), result);
}

}  // namespace move_base_abstract
