// ROS parameters that the thread with the turn sets or reads. A new value takes effect for other
// nodes with its round; the program itself sees it at once.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "lockstep/wire/wire.h"
#include "turn.h"

namespace move_base_abstract::shim {

/** @brief What came of a question to the ROS master: for a parameter that does not exist it is
 * kRefused. */
enum class Asked { kGood, kRefused, kNotAnswered };

/** @brief Ask the ROS master: method, request, answer. */
using AskMaster =
    std::function<Asked(const std::string&, const XmlRpc::XmlRpcValue&, XmlRpc::XmlRpcValue&)>;

/** @brief Parameters that were set or deleted and are not reported yet, by rosmaster's rules. */
class PendingParameters {
 public:
  using Words = std::vector<std::string>;  // the words of an absolute name; none: the root

  bool empty() const { return changes_.empty(); }
  void clear() { changes_.clear(); }
  void set(const std::string& name, const XmlRpc::XmlRpcValue& value);
  void erase(const std::string& name);

  /** @return whether one of these changes affects the value of @p name. */
  bool concern(const std::string& name) const;
  /** @return the value of @p name after these changes; @p current is the value before. An invalid
   * value means that the parameter does not exist. */
  XmlRpc::XmlRpcValue seen(const std::string& name, const XmlRpc::XmlRpcValue& current) const;
  /** @return the names of all parameters after these changes; @p names: those before. */
  std::vector<std::string> names(const std::vector<std::string>& names) const;

 private:
  struct Change {
    Words words;
    XmlRpc::XmlRpcValue value;  // invalid: deleted
  };

  std::vector<Change> changes_;
};

/** @brief Answers the program's calls to the ROS master about parameters. @pre The thread has the
 * turn. */
class Parameters {
 public:
  static bool isAbout(const std::string& method);
  /** @return whether the call succeeds, as with the ROS master. */
  bool answer(const std::string& method, const XmlRpc::XmlRpcValue& request,
              XmlRpc::XmlRpcValue& answer, const AskMaster& ask);
  /** @brief Note that all changes are reported. */
  void reported();
  /** @brief Ask the ROS master each time from now on, because a process that takes no part may set
   * parameters, of which the time master hears only later. */
  void keepNoAnswers() { keeps_ = false; }
  /** @brief Wait until the ROS master has the changes of this turn, because a process that takes no
   * part is about to start and may read them. */
  void settle();

 private:
  bool isSet(const std::string& name, const XmlRpc::XmlRpcValue& request, const AskMaster& ask);
  bool search(const XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& answer,
              const AskMaster& ask);
  bool get(const std::string& name, const XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& answer,
           const AskMaster& ask);
  bool names(const XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& answer, const AskMaster& ask);
  bool askMaster(const char* method, const std::string& name, const XmlRpc::XmlRpcValue& request,
                 XmlRpc::XmlRpcValue& answer, const AskMaster& ask);
  void note(const std::string& name);
  void look(const std::string& name);
  /** @brief Label the run, once for each name, if roslaunch sets @p name anew in each run. */
  void tellOfRoslaunch(const std::string& name);

  struct Kept {
    bool is_good = false;
    XmlRpc::XmlRpcValue answer;
  };

  PendingParameters pending_;
  std::map<std::pair<std::string, std::string>, Kept> kept_;  // by method and name
  std::uint64_t changes_ = 0;                                 // when these answers were given
  bool keeps_ = true;
  std::set<std::string> asked_;
  std::set<std::string> told_;
  std::map<std::string, Repeated> looks_;
};

Parameters& parameters();

/** @brief Label the run if a node that looks on may have @p what, which has not come in time. */
void tellInVain(const std::string& what);

}  // namespace move_base_abstract::shim
