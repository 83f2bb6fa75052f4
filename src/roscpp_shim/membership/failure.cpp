#include "failure.h"

#include <XmlRpc.h>
#include <poll.h>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/xmlrpc_manager.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "stop_signals.h"

namespace ros {

/** roscpp's own handler of a request to shut down; no header declares it. */
void shutdownCallback(XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& response);

}  // namespace ros

namespace move_base_abstract::lockstep::internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kOwnSignal{1};  // wall
constexpr int kLookMilliseconds = 10;          // wall

const char* const kNamesake = "same name";  // part of the ROS master's reason

std::atomic<bool> has_failed{false};
std::atomic<bool> is_replaced{false};

void endWithError() {
  if (has_failed) {
    std::fflush(nullptr);
    std::_Exit(1);
  }
}

/**
 * Runs as soon as the library is loaded, so that endWithError() comes after everything that the
 * program does at its end.
 */
__attribute__((constructor)) void watchEnd() { std::atexit(endWithError); }

void onShutdown(XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& response) {
  if (request.getType() == XmlRpc::XmlRpcValue::TypeArray && request.size() > 1 &&
      request[1].getType() == XmlRpc::XmlRpcValue::TypeString &&
      static_cast<std::string>(request[1]).find(kNamesake) != std::string::npos) {
    is_replaced = true;
  }
  ros::shutdownCallback(request, response);
}

}  // namespace

void fail(const std::string& name, const std::string& reason) {
  has_failed = true;
  if (ros::isShuttingDown()) {  // the log may be closed already
    std::fprintf(stderr, "[FATAL] lockstep: the run is over for %s: %s\n", name.c_str(),
                 reason.c_str());
  } else {
    ROS_FATAL("lockstep: the run is over for %s: %s", name.c_str(), reason.c_str());
  }
}

bool awaitsOwnSignal() {
  const auto end = Clock::now() + kOwnSignal;
  while (ros::ok() && !stopSignalCame() && Clock::now() < end) {
    ::poll(nullptr, 0, kLookMilliseconds);
  }
  return !ros::ok() || stopSignalCame();
}

void watchForNamesake() {
  // The first handler stays, so the one that ros::start() binds later has no effect.
  ros::XMLRPCManager::instance()->bind("shutdown", onShutdown);
}

bool isReplaced() { return is_replaced; }

}  // namespace move_base_abstract::lockstep::internal
