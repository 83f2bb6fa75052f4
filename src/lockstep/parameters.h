// ROS parameters: the values that participants set, and the nodes that depend on parameters which
// others may set.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "lockstep/wire/wire.h"

namespace move_base_abstract {

/** @brief A change of a parameter, of which the ROS master is to be told before the next grants. */
struct ParameterChange {
  std::string by;     // the node's name
  std::string name;   // absolute
  std::string value;  // as XML-RPC; empty: it is deleted
};

/**
 * @return why @p item, which @p by sets or deletes, is not a valid parameter; '' if it is valid.
 */
std::string faultOf(std::string_view by, const wire::Parameter& item);

/**
 * @brief The parameters of a run. Names are absolute. A name stands for the parameters below it,
 * too.
 */
class ParameterBook {
 public:
  /** @brief A participant sets or deletes a parameter. Call this in the stated order. */
  void change(std::string_view by, const wire::Parameter& item);
  /** @return the changes since the last call, in their order. */
  std::vector<ParameterChange> take();

  /** @return the nodes that have asked for a parameter which has changed since the last call. */
  std::set<std::string> concerned();

  /**
   * @brief A participant has asked for a parameter. @return the label that the run gets for it; ''
   * if none.
   */
  std::string asks(std::string_view by, std::string_view name);
  /**
   * @brief A node that does not take part has set or deleted a parameter. @return the label that
   * the run gets for it; '' if none.
   */
  std::string changedOutside(std::string_view name);

 private:
  std::vector<ParameterChange> changes_;
  std::map<std::string, std::string, std::less<>> asked_;  // parameter -> the node that asked first
  std::map<std::string, std::set<std::string>> askers_;    // node -> its parameters
  std::set<std::string> changed_;
  std::set<std::string, std::less<>> outside_;
};

}  // namespace move_base_abstract
