#include "namesake.h"

#include <XmlRpc.h>
#include <ros/xmlrpc_manager.h>

#include <atomic>
#include <string>

namespace ros {

/** roscpp's own handler of a request to shut down; no header declares it. */
void shutdownCallback(XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& response);

}  // namespace ros

namespace move_base_abstract::lockstep::internal {
namespace {

const char* const kNamesake = "same name";  // part of the ROS master's reason

std::atomic<bool> is_replaced{false};

void onShutdown(XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& response) {
  if (request.getType() == XmlRpc::XmlRpcValue::TypeArray && request.size() > 1 &&
      request[1].getType() == XmlRpc::XmlRpcValue::TypeString &&
      static_cast<std::string>(request[1]).find(kNamesake) != std::string::npos) {
    is_replaced = true;
  }
  ros::shutdownCallback(request, response);
}

}  // namespace

void watchForNamesake() {
  // The first handler stays, so the one that ros::start() binds later has no effect.
  ros::XMLRPCManager::instance()->bind("shutdown", onShutdown);
}

bool isReplaced() { return is_replaced; }

}  // namespace move_base_abstract::lockstep::internal
