// Parameters of ROS as participants set them: the ROS master is told, and tells of all others.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_PARAMETER_KEEPER_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_PARAMETER_KEEPER_H

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "lockstep/parameters.h"
#include "parameters_at_start.h"

namespace move_base_abstract {

class NodeProbe;

/** @brief Has the ROS master set what participants have set, and hears what anybody else sets. */
class ParameterKeeper {
 public:
  using Listener = std::function<void(const std::string& name)>;

  ParameterKeeper();
  ~ParameterKeeper();
  ParameterKeeper(const ParameterKeeper&) = delete;
  ParameterKeeper& operator=(const ParameterKeeper&) = delete;

  /**
   * @brief Have @p outside called, in a thread of roscpp, for each parameter that another process
   * sets or deletes.
   * @throws std::runtime_error if the ROS master does not agree.
   */
  void listen(Listener outside);
  /** @brief The listener is not called any more. */
  void stop();
  /**
   * @brief The run begins: what is as it is now was set before, however late the ROS master tells.
   * (It tells a tenth of a second late, as a rule.)
   */
  void remember();
  /** @return those that the ROS master has not taken within 10 s of wall time. From one thread. */
  std::vector<ParameterChange> apply(const std::vector<ParameterChange>& changes);

 private:
  void onUpdate(XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& response);
  bool isOwn(const std::string& name);
  bool isAsAtTheStart(const std::string& name, const XmlRpc::XmlRpcValue& value);
  void applySome(const std::vector<ParameterChange>& changes,
                 std::vector<ParameterChange>* refused);
  bool tell(const XmlRpc::XmlRpcValue& calls, XmlRpc::XmlRpcValue& answers);

  Listener outside_;
  std::unique_ptr<NodeProbe> master_;  // of apply()
  std::mutex mutex_;
  ParametersAtStart at_start_;
  std::map<std::string, int> deleted_;  // by apply(), of which the ROS master is going to tell
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_PARAMETER_KEEPER_H
