// What parameters were when a run began: what the ROS master tells late is no set from outside.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_PARAMETERS_AT_START_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_PARAMETERS_AT_START_H

#include <xmlrpcpp/XmlRpcValue.h>

#include <memory>
#include <set>
#include <string>

namespace move_base_abstract {

/** @brief All parameters as they were at the start, and which of them participants have changed. */
class ParametersAtStart {
 public:
  /** @param all the value of "/"; nothing valid if the ROS master has not answered. */
  void remember(const XmlRpc::XmlRpcValue& all);
  /** @brief A participant has set or deleted @p name, with all that is below it. */
  void change(const std::string& name);
  /**
   * @param name full, without a slash at its end.
   * @param value as the ROS master tells it: an empty struct for what was deleted.
   * @return whether @p value is what the parameter had at the start, and no participant changed it
   * since. What is told before remember() is so, even if the run has just begun.
   */
  bool hold(const std::string& name, const XmlRpc::XmlRpcValue& value) const;

 private:
  bool isChanged(const std::string& name) const;

  std::unique_ptr<XmlRpc::XmlRpcValue> all_;
  std::set<std::string> changed_;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_PARAMETERS_AT_START_H
