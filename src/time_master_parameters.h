// Reads and checks the time master node's private parameters.
#ifndef MOVE_BASE_ABSTRACT_SRC_TIME_MASTER_PARAMETERS_H
#define MOVE_BASE_ABSTRACT_SRC_TIME_MASTER_PARAMETERS_H

#include <ros/ros.h>

#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include "move_base_abstract/time_master.h"

namespace move_base_abstract {

/** @brief Typed look-ups below one namespace; remembers which keys it knows. */
class ParameterReader {
 public:
  explicit ParameterReader(const ros::NodeHandle& node) : node_(node) {}

  /** @brief Replace @p value by the parameter, if set. @throws std::invalid_argument */
  void read(const std::string& key, double& value) {
    XmlRpc::XmlRpcValue raw;
    if (!find(key, raw)) {
      return;
    }
    if (raw.getType() == XmlRpc::XmlRpcValue::TypeInt) {
      value = static_cast<int>(raw);
    } else if (raw.getType() == XmlRpc::XmlRpcValue::TypeDouble) {
      value = static_cast<double>(raw);
    } else {
      refuse(key, "a number", raw);
    }
  }

  /** @brief Replace @p value by the parameter, if set. @throws std::invalid_argument */
  void read(const std::string& key, bool& value) {
    XmlRpc::XmlRpcValue raw;
    if (!find(key, raw)) {
      return;
    }
    if (raw.getType() != XmlRpc::XmlRpcValue::TypeBoolean) {
      refuse(key, "true or false", raw);
    }
    value = static_cast<bool>(raw);
  }

  /** @brief Log a warning for each parameter of this namespace that was not asked for. */
  void warnOfUnknown() const {
    std::vector<std::string> names;
    ros::param::getParamNames(names);
    const std::string prefix = node_.getNamespace() + "/";
    std::string known;
    for (const std::string& key : known_) {
      known += (known.empty() ? "" : ", ") + key;
    }
    for (const std::string& name : names) {
      if (name.rfind(prefix, 0) == 0 && known_.count(name.substr(prefix.size())) == 0) {
        ROS_WARN("parameter %s is unknown and ignored; known are: %s", name.c_str(), known.c_str());
      }
    }
  }

 private:
  bool find(const std::string& key, XmlRpc::XmlRpcValue& raw) {
    known_.insert(key);
    return node_.getParam(key, raw);
  }

  [[noreturn]] void refuse(const std::string& key, const char* wanted, XmlRpc::XmlRpcValue& raw) {
    std::ostringstream got;
    raw.write(got);
    throw std::invalid_argument(
        key + " must be " + wanted + ", got '" + got.str() + "'" +
        (raw.getType() == XmlRpc::XmlRpcValue::TypeString ? " (text)" : ""));
  }

  ros::NodeHandle node_;
  std::set<std::string> known_;
};

struct NodeParameters {
  TimeMaster::Settings master;
  double state_rate = 2.0;  // state messages per wall second, 0.1 to 100; also one on each change
};

/** @throws std::invalid_argument that begins with the key of a parameter of a wrong type. */
inline NodeParameters readParameters(const ros::NodeHandle& node) {
  NodeParameters parameters;
  ParameterReader reader(node);
  reader.read("factor", parameters.master.factor);
  reader.read("busy_factor", parameters.master.busy_factor);
  reader.read("finest_step", parameters.master.finest_step);
  reader.read("max_clock_rate", parameters.master.max_clock_rate);
  reader.read("start_time", parameters.master.start_time);
  reader.read("start_paused", parameters.master.start_paused);
  reader.read("repeat_rate", parameters.master.repeat_rate);
  reader.read("state_rate", parameters.state_rate);
  if (!(parameters.state_rate >= 0.1 && parameters.state_rate <= 100.0)) {
    std::ostringstream text;
    text << "state_rate must be from 0.1 to 100 Hz, got " << parameters.state_rate;
    throw std::invalid_argument(text.str());
  }
  reader.warnOfUnknown();
  return parameters;
}

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_SRC_TIME_MASTER_PARAMETERS_H
