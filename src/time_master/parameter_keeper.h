// ROS parameters: passes the changes of participants to the ROS master, and hears of all others
// from it.
#pragma once

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

/**
 * @brief Sets parameters in the ROS master as participants do, and notices changes by other
 * processes.
 */
class ParameterKeeper {
 public:
  using Listener = std::function<void(const std::string& name)>;

  ParameterKeeper();
  ~ParameterKeeper();
  ParameterKeeper(const ParameterKeeper&) = delete;
  ParameterKeeper& operator=(const ParameterKeeper&) = delete;

  /**
   * @brief Call @p outside, in a thread of roscpp, for each parameter that another process sets or
   * deletes.
   * @throws std::runtime_error if the ROS master does not accept the subscription.
   */
  void listen(Listener outside);
  /** @brief Stop calling the listener. */
  void stop();
  /**
   * @brief Remember all parameters, as the run begins. A parameter that still has this value was
   * set before, even if the ROS master reports it only later. (Its reports are usually a tenth of a
   * second late.)
   */
  void remember();
  /**
   * @brief Apply changes in the ROS master. Call this from one thread only. @return the changes
   * that it has not accepted within 10 s of wall time.
   */
  std::vector<ParameterChange> apply(const std::vector<ParameterChange>& changes);

 private:
  void onUpdate(XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& response);
  bool isOwn(const std::string& name);
  bool isAsAtTheStart(const std::string& name, const XmlRpc::XmlRpcValue& value);
  void applySome(const std::vector<ParameterChange>& changes,
                 std::vector<ParameterChange>* refused);
  bool tell(const XmlRpc::XmlRpcValue& calls, XmlRpc::XmlRpcValue& answers);

  Listener outside_;
  std::unique_ptr<NodeProbe> master_;  // for apply()
  std::mutex mutex_;
  ParametersAtStart at_start_;
  std::map<std::string, int> deleted_;  // by apply(); the ROS master will report them
};

}  // namespace move_base_abstract
