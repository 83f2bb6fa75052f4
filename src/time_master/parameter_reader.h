// Reads the private parameters of a node, and remembers which it knows.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_PARAMETER_READER_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_PARAMETER_READER_H

#include <ros/ros.h>

#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "clock/list_of_texts.h"
#include "clock/shown_text.h"

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

  /** @brief Replace @p value by the parameter, if set. @throws std::invalid_argument */
  void read(const std::string& key, int& value) {
    XmlRpc::XmlRpcValue raw;
    if (!find(key, raw)) {
      return;
    }
    if (raw.getType() != XmlRpc::XmlRpcValue::TypeInt) {
      refuse(key, "a whole number", raw);
    }
    value = static_cast<int>(raw);
  }

  /** @brief Replace @p value by the parameter, if set. @throws std::invalid_argument */
  void read(const std::string& key, std::string& value) {
    XmlRpc::XmlRpcValue raw;
    if (!find(key, raw)) {
      return;
    }
    if (raw.getType() != XmlRpc::XmlRpcValue::TypeString) {
      refuse(key, "a text", raw);
    }
    value = static_cast<std::string>(raw);
  }

  /**
   * @brief Replace @p value by the parameter, if set. @throws std::invalid_argument
   *
   * A text "[a, b]" is a list too: roscpp takes what a command line gives (_key:="[a, b]") for one.
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

  /** @brief Replace @p value by what @p choices has for the parameter's text, if that is set. */
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

  /** @brief Where the list came as a text, have others find a list. */
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

  /** @brief A parameter of this name is not unknown. */
  void know(const std::string& key) { known_.insert(key); }

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
        key + " must be " + wanted + ", got '" + shown(got.str()) + "'" +
        (raw.getType() == XmlRpc::XmlRpcValue::TypeString ? " (text)" : ""));
  }

  ros::NodeHandle node_;
  std::set<std::string> known_;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_PARAMETER_READER_H
