#include "parameter_keeper.h"

#include <ros/master.h>
#include <ros/this_node.h>
#include <ros/xmlrpc_manager.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "node_probe.h"

namespace move_base_abstract {
namespace {

constexpr std::chrono::milliseconds kAnswerLimit{10000};  // wall, for an answer
constexpr std::size_t kAtOnce = 500;                      // changes in one request
constexpr const char* kUpdate = "paramUpdate";

/**
 * @return the change as a part of a multicall; an invalid value if the change cannot be decoded.
 */
XmlRpc::XmlRpcValue callOf(const ParameterChange& change) {
  XmlRpc::XmlRpcValue call;
  call["methodName"] = change.value.empty() ? "deleteParam" : "setParam";
  call["params"][0] = ros::this_node::getName();
  call["params"][1] = change.name;
  if (!change.value.empty()) {
    int offset = 0;
    const XmlRpc::XmlRpcValue value(change.value, &offset);
    if (!value.valid()) {
      return {};
    }
    call["params"][2] = value;
  }
  return call;
}

/** @return whether the answer to one call of a multicall is a success. */
bool isGood(const XmlRpc::XmlRpcValue& answer) {
  using Value = XmlRpc::XmlRpcValue;
  return answer.getType() == Value::TypeArray && answer.size() == 1 &&
         answer[0].getType() == Value::TypeArray && answer[0].size() == 3 &&
         answer[0][0].getType() == Value::TypeInt && static_cast<int>(answer[0][0]) == 1;
}

XmlRpc::XmlRpcValue subscription() {
  XmlRpc::XmlRpcValue request;
  request[0] = ros::this_node::getName();
  request[1] = ros::XMLRPCManager::instance()->getServerURI();
  request[2] = "/";
  return request;
}

}  // namespace

ParameterKeeper::ParameterKeeper() = default;

ParameterKeeper::~ParameterKeeper() { stop(); }

void ParameterKeeper::remember() {
  XmlRpc::XmlRpcValue request;
  request[0] = ros::this_node::getName();
  request[1] = "/";
  XmlRpc::XmlRpcValue all;
  masterProbe().call("getParam", request, kAnswerLimit, all);
  const std::lock_guard<std::mutex> lock(mutex_);
  at_start_.remember(all);
}

bool ParameterKeeper::isAsAtTheStart(const std::string& name, const XmlRpc::XmlRpcValue& value) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return at_start_.hold(name, value);
}

/** Stop calling the listener. roscpp waits for a call under way. */
void ParameterKeeper::stop() {
  if (outside_) {
    ros::XMLRPCManager::instance()->unbind(kUpdate);
    outside_ = nullptr;
  }
}

void ParameterKeeper::listen(Listener outside) {
  outside_ = std::move(outside);
  const ros::XMLRPCManagerPtr manager = ros::XMLRPCManager::instance();
  manager->unbind(kUpdate);  // roscpp's own handler, which only serves getCached()
  manager->bind(kUpdate, [this](XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& response) {
    onUpdate(request, response);
  });
  XmlRpc::XmlRpcValue ignored;
  if (!masterProbe().call("subscribeParam", subscription(), kAnswerLimit, ignored)) {
    throw std::runtime_error("the ROS master at " + ros::master::getURI() +
                             " does not report changes of parameters");
  }
}

std::vector<ParameterChange> ParameterKeeper::apply(const std::vector<ParameterChange>& changes) {
  std::vector<ParameterChange> refused;
  for (std::size_t begin = 0; begin < changes.size(); begin += kAtOnce) {
    const std::size_t end = std::min(changes.size(), begin + kAtOnce);
    applySome({changes.begin() + static_cast<std::ptrdiff_t>(begin),
               changes.begin() + static_cast<std::ptrdiff_t>(end)},
              &refused);
  }
  return refused;
}

/**
 * @brief Apply changes in one request. The ROS master reports a set value to all except the node
 * that set it, but it reports a deletion to that node, too.
 */
void ParameterKeeper::applySome(const std::vector<ParameterChange>& changes,
                                std::vector<ParameterChange>* refused) {
  XmlRpc::XmlRpcValue request, answers;
  std::vector<ParameterChange> asked;
  for (const ParameterChange& change : changes) {
    XmlRpc::XmlRpcValue call = callOf(change);
    if (!call.valid()) {
      refused->push_back(change);
      continue;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    at_start_.change(change.name);
    if (change.value.empty()) {
      ++deleted_[change.name];
    }
    request[0][static_cast<int>(asked.size())] = call;
    asked.push_back(change);
  }
  const bool is_answered = !asked.empty() && tell(request, answers) &&
                           answers.getType() == XmlRpc::XmlRpcValue::TypeArray;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const bool is_there = is_answered && static_cast<int>(k) < answers.size();
    if (is_there && isGood(answers[static_cast<int>(k)])) {
      continue;
    }
    // A deletion may fail because an earlier action of the same round has deleted the parameter.
    if (asked[k].value.empty()) {
      isOwn(asked[k].name);
    }
    if (!is_there || !asked[k].value.empty()) {
      refused->push_back(asked[k]);
    }
  }
}

/** @brief Send a request over one connection for all rounds; after a failure, over a new one. */
bool ParameterKeeper::tell(const XmlRpc::XmlRpcValue& calls, XmlRpc::XmlRpcValue& answers) {
  if (!master_) {
    master_ = std::make_unique<NodeProbe>(ros::master::getHost(),
                                          static_cast<int>(ros::master::getPort()));
  }
  const bool is_answered = master_->ask("system.multicall", calls, kAnswerLimit, answers);
  if (!is_answered) {
    master_.reset();
  }
  return is_answered;
}

/** @return whether apply() has deleted the parameter, which the ROS master reports once. */
bool ParameterKeeper::isOwn(const std::string& name) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = deleted_.find(name);
  if (found == deleted_.end()) {
    return false;
  }
  if (--found->second == 0) {
    deleted_.erase(found);
  }
  return true;
}

void ParameterKeeper::onUpdate(XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& response) {
  response = ros::xmlrpc::responseInt(1, "", 0);
  if (request.getType() != XmlRpc::XmlRpcValue::TypeArray || request.size() < 3 ||
      request[1].getType() != XmlRpc::XmlRpcValue::TypeString) {
    return;
  }
  std::string name = request[1];
  while (name.size() > 1 && name.back() == '/') {
    name.pop_back();
  }
  const bool is_deletion =
      request[2].getType() == XmlRpc::XmlRpcValue::TypeStruct && request[2].size() == 0;
  if (!(is_deletion && isOwn(name)) && !isAsAtTheStart(name, request[2])) {
    outside_(name);
  }
}

}  // namespace move_base_abstract
