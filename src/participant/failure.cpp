#include "failure.h"

#include <XmlRpc.h>
#include <poll.h>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/master.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "stop_signals.h"

namespace move_base_abstract::lockstep::internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kOwnSignal{1};    // wall
constexpr std::chrono::seconds kMasterLimit{1};  // wall
constexpr int kLookMilliseconds = 10;            // wall

std::atomic<bool> has_failed{false};

void endWithError() {
  if (has_failed) {
    std::fflush(nullptr);
    std::_Exit(1);
  }
}

/** @brief One question to the ROS master that does not wait for ever. */
class Question : private XmlRpc::XmlRpcClient {
 public:
  Question()
      : XmlRpcClient(ros::master::getHost().c_str(), static_cast<int>(ros::master::getPort()),
                     "/") {}

  bool ask(const char* method, const XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& response) {
    const auto end = Clock::now() + kMasterLimit;
    bool is_answered = false;
    for (bool is_asked = executeNonBlock(method, request);
         is_asked && !is_answered && Clock::now() < end;) {
      _disp.work(0.05);
      is_answered = executeCheckDone(response);
    }
    return is_answered && response.valid();
  }
};

/** As soon as the library is loaded, so that it comes after all that the program has to do at its
 * end. */
__attribute__((constructor)) void watchEnd() { std::atexit(endWithError); }

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

bool isNameTaken(const Presence& presence) {
  XmlRpc::XmlRpcValue request, response;
  request[0] = presence.name;
  request[1] = presence.name;
  if (!Question().ask("lookupNode", request, response) ||
      response.getType() != XmlRpc::XmlRpcValue::TypeArray || response.size() != 3) {
    return false;
  }
  XmlRpc::XmlRpcValue& code = response[0];
  XmlRpc::XmlRpcValue& uri = response[2];
  return code.getType() == XmlRpc::XmlRpcValue::TypeInt && static_cast<int>(code) == 1 &&
         uri.getType() == XmlRpc::XmlRpcValue::TypeString &&
         static_cast<std::string>(uri) != presence.uri;
}

}  // namespace move_base_abstract::lockstep::internal
