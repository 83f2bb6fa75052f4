// Parameters of ROS: what participants set, and who asks for what others may set.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_PARAMETERS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_PARAMETERS_H

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "lockstep/wire/wire.h"

namespace move_base_abstract {

/** @brief What the ROS master is to be told before the next grants. */
struct ParameterChange {
  std::string by;     // the node's name
  std::string name;   // absolute
  std::string value;  // as XML-RPC says it; empty: it is deleted
};

/** @return why @p item, which @p by sets or deletes, is no parameter; '' if it is one. */
std::string faultOf(std::string_view by, const wire::Parameter& item);

/** @brief The parameters of a run. Names are absolute; one contains those below it. */
class ParameterBook {
 public:
  /** @brief A participant sets or deletes one, in the stated order. */
  void change(std::string_view by, const wire::Parameter& item);
  /** @return the changes since the last call, in their order. */
  std::vector<ParameterChange> take();

  /** @return who has asked for any that have changed since the last call. */
  std::set<std::string> concerned();

  /** @brief A participant has asked for one. @return why that labels the run; '' if it does not. */
  std::string asks(std::string_view by, std::string_view name);
  /** @brief Somebody who takes no part has set or deleted one. @return the same. */
  std::string changedOutside(std::string_view name);

 private:
  std::vector<ParameterChange> changes_;
  std::map<std::string, std::string, std::less<>> asked_;  // by whom first
  std::map<std::string, std::set<std::string>> askers_;    // by name: what each has asked for
  std::set<std::string> changed_;
  std::set<std::string, std::less<>> outside_;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_PARAMETERS_H
