// The values of parameters at the beginning of a run, so that a late report of the ROS master does
// not count as a change from outside.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include <memory>
#include <set>
#include <string>

namespace move_base_abstract {

/** @brief All parameters as they were at the start, and those that participants have changed. */
class ParametersAtStart {
 public:
  /** @param all the value of "/"; an invalid value if the ROS master has not answered. */
  void remember(const XmlRpc::XmlRpcValue& all);
  /** @brief Note that a participant has set or deleted @p name, with everything below it. */
  void change(const std::string& name);
  /**
   * @param name full, without a slash at its end.
   * @param value as the ROS master reports it: an empty struct for a deleted parameter.
   * @return whether the parameter had @p value at the start, and no participant has changed it
   * since. Before remember() this is always true, even if the run has just begun.
   */
  bool hold(const std::string& name, const XmlRpc::XmlRpcValue& value) const;

 private:
  bool isChanged(const std::string& name) const;

  std::unique_ptr<XmlRpc::XmlRpcValue> all_;
  std::set<std::string> changed_;
};

}  // namespace move_base_abstract
