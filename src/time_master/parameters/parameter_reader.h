// Reads single parameters of the time master node, and checks their types.
#pragma once

#include <ros/ros.h>

#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "clock/list_of_texts.h"
#include "clock/shown_text.h"
#include "parameter_table.h"

namespace move_base_abstract {

constexpr const char* kAddress = "lockstep_address";  // not a setting; a killed run leaves it

/**
 * @brief Typed look-ups of the parameters in the table, below one namespace, as they are when this
 * is made. They are asked for in one question, since each takes as long, whatever it is about.
 */
class ParameterReader {
 public:
  explicit ParameterReader(const ros::NodeHandle& node)
      : node_(node),
        are_known_(node_.getParam(node_.getNamespace(), all_) &&
                   all_.getType() == XmlRpc::XmlRpcValue::TypeStruct) {}

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
    checkRange(key, value);
  }

  /** @brief Replace @p value by the parameter, if set. @throws std::invalid_argument */
  void read(const std::string& key, bool& value) {
    readAs(XmlRpc::XmlRpcValue::TypeBoolean, "true or false", key, value);
  }

  /** @brief Replace @p value by the parameter, if set. @throws std::invalid_argument */
  void read(const std::string& key, int& value) {
    readAs(XmlRpc::XmlRpcValue::TypeInt, "a whole number", key, value);
    checkRange(key, value);
  }

  /** @brief Replace @p value by the parameter, if set. @throws std::invalid_argument */
  void read(const std::string& key, std::string& value) {
    readAs(XmlRpc::XmlRpcValue::TypeString, "a text", key, value);
  }

  /**
   * @brief Replace @p value by the parameter, if set. @throws std::invalid_argument
   *
   * A text "[a, b]" counts as a list, too, because roscpp reads an argument such as _key:="[a, b]"
   * as a text.
   */
  void read(const std::string& key, std::vector<std::string>& value) {
    const char* const wanted = "a list of texts, such as [a, b]";
    XmlRpc::XmlRpcValue raw;
    if (!find(key, raw)) {
      return;
    }
    if (raw.getType() == XmlRpc::XmlRpcValue::TypeString) {
      const auto parsed = listOfTexts(static_cast<std::string>(raw));
      if (!parsed) {
        refuse(key, wanted, raw);
      }
      value = *parsed;
      return;
    }
    if (raw.getType() != XmlRpc::XmlRpcValue::TypeArray) {
      refuse(key, wanted, raw);
    }
    value.clear();
    for (int index = 0; index < raw.size(); ++index) {
      if (raw[index].getType() != XmlRpc::XmlRpcValue::TypeString) {
        refuse(key, wanted, raw);
      }
      value.push_back(static_cast<std::string>(raw[index]));
    }
  }

  /**
   * @brief Replace @p value by the entry of @p choices for the parameter's text, if that is set.
   * @throws std::invalid_argument if there is no such entry.
   */
  template <typename Value>
  void choose(const std::string& key, const std::map<std::string, Value>& choices, Value& value) {
    std::string chosen;
    for (const auto& choice : choices) {
      chosen = choice.second == value ? choice.first : chosen;
    }
    read(key, chosen);
    const auto found = choices.find(chosen);
    if (found == choices.end()) {
      std::string allowed;
      for (const auto& choice : choices) {
        allowed += (allowed.empty() ? "" : " or ") + choice.first;
      }
      throw std::invalid_argument(key + " must be " + allowed + ", got '" + chosen + "'");
    }
    value = found->second;
  }

  /** @brief If the parameter is a text, set it to @p list, so that other nodes find a list. */
  void replaceText(const std::string& key, const std::vector<std::string>& list) {
    XmlRpc::XmlRpcValue raw;
    if (find(key, raw) && raw.getType() == XmlRpc::XmlRpcValue::TypeString) {
      XmlRpc::XmlRpcValue value;
      value.setSize(static_cast<int>(list.size()));
      for (std::size_t index = 0; index < list.size(); ++index) {
        value[static_cast<int>(index)] = list[index];
      }
      node_.setParam(key, value);
    }
  }

  /** @brief Log a warning for each parameter of this namespace that is not in the table. */
  void warnOfUnknown() const {
    std::vector<std::string> names;
    ros::param::getParamNames(names);
    const std::string prefix = node_.getNamespace() + "/";
    std::string known;
    for (const ParameterRow& row : kParameterTable) {
      known += (known.empty() ? "" : ", ") + std::string(row.name);
    }
    for (const std::string& name : names) {
      const std::string key = name.rfind(prefix, 0) == 0 ? name.substr(prefix.size()) : kAddress;
      if (key != kAddress && !isParameter(key)) {
        ROS_WARN("parameter %s is unknown and ignored; known are: %s", name.c_str(), known.c_str());
      }
    }
  }

 private:
  template <typename Value>
  void readAs(XmlRpc::XmlRpcValue::Type type, const char* wanted, const std::string& key,
              Value& value) {
    XmlRpc::XmlRpcValue raw;
    if (!find(key, raw)) {
      return;
    }
    if (raw.getType() != type) {
      refuse(key, wanted, raw);
    }
    value = static_cast<Value&>(raw);
  }

  /** @return whether the parameter is set; then @p raw is its value. */
  bool find(const std::string& key, XmlRpc::XmlRpcValue& raw) {
    if (!isParameter(key)) {
      throw std::logic_error(key + " has no row in parameter_table.h");
    }
    if (!are_known_) {
      return node_.getParam(key, raw);
    }
    const bool is_set = all_.hasMember(key);
    raw = is_set ? all_[key] : raw;
    return is_set;
  }

  [[noreturn]] void refuse(const std::string& key, const char* wanted, XmlRpc::XmlRpcValue& raw) {
    std::ostringstream got;
    raw.write(got);
    throw std::invalid_argument(
        key + " must be " + wanted + ", got '" + shown(got.str()) + "'" +
        (raw.getType() == XmlRpc::XmlRpcValue::TypeString ? " (text)" : ""));
  }

  ros::NodeHandle node_;
  XmlRpc::XmlRpcValue all_;  // by key
  bool are_known_;           // otherwise none is set, or the answer as a whole cannot be read
};

}  // namespace move_base_abstract
