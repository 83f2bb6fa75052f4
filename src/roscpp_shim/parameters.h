// Parameters of ROS, set and asked for by the thread that has the turn: a set takes effect with its
// round, and is seen by the program itself at once.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_PARAMETERS_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_PARAMETERS_H

#include <xmlrpcpp/XmlRpcValue.h>

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "lockstep/wire/wire.h"

namespace move_base_abstract::shim {

/** @brief Ask the ROS master. @return whether it says yes; the answer is in the last argument. */
using AskMaster =
    std::function<bool(const std::string&, const XmlRpc::XmlRpcValue&, XmlRpc::XmlRpcValue&)>;

/** @brief What was set and deleted and has not been reported, by rosmaster's rules. */
class PendingParameters {
 public:
  using Words = std::vector<std::string>;  // of an absolute name; none: the root

  bool empty() const { return changes_.empty(); }
  void clear() { changes_.clear(); }
  void set(const std::string& name, const XmlRpc::XmlRpcValue& value);
  void erase(const std::string& name);

  /** @return whether any of them changes what @p name is. */
  bool concern(const std::string& name) const;
  /** @return what @p name is after them; @p current: before. Either may be invalid: not there. */
  XmlRpc::XmlRpcValue seen(const std::string& name, const XmlRpc::XmlRpcValue& current) const;
  /** @return the names of all parameters after them; @p names: before. */
  std::vector<std::string> names(const std::vector<std::string>& names) const;

 private:
  struct Change {
    Words words;
    XmlRpc::XmlRpcValue value;  // invalid: deleted
  };

  std::vector<Change> changes_;
};

/** @brief Answers calls of the ROS master about parameters; for the thread that has the turn. */
class Parameters {
 public:
  static bool isAbout(const std::string& method);
  /** @return whether the call is a success, as the ROS master would say. */
  bool answer(const std::string& method, const XmlRpc::XmlRpcValue& request,
              XmlRpc::XmlRpcValue& answer, const AskMaster& ask);
  /** @brief What was set has been reported. */
  void reported() { pending_.clear(); }
  /** @brief Have the ROS master know what was set in this turn: a process that takes no part is
   * about to begin, and may look. */
  void settle();

 private:
  bool isSet(const std::string& name, const XmlRpc::XmlRpcValue& request, const AskMaster& ask);
  bool search(const XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& answer,
              const AskMaster& ask);
  bool get(const std::string& name, const XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& answer,
           const AskMaster& ask);
  bool names(const XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& answer, const AskMaster& ask);
  void note(const std::string& name);
  void look(const std::string& name);
  /** @brief What roslaunch makes anew for each run is told once. */
  void tellOfRoslaunch(const std::string& name);

  struct Look {
    unsigned count = 0;
    Nanoseconds at = 0;  // simulated
  };

  PendingParameters pending_;
  std::set<std::string> asked_;
  std::set<std::string> told_;
  std::map<std::string, Look> looks_;
};

Parameters& parameters();

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_PARAMETERS_H
