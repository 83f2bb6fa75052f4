// Where roscpp programs begin and end.
#include <ros/init.h>

#include <cstdlib>
#include <sstream>
#include <string>

#include "node.h"
#include "real.h"
#include "turn.h"

namespace move_base_abstract::shim {
namespace {

thread_local bool t_is_starting = false;

}  // namespace

/** Programs that this one starts are not preloaded too. */
__attribute__((constructor)) void leaveEnvironment() {
  const char* const preload = std::getenv("LD_PRELOAD");
  std::istringstream names(preload == nullptr ? "" : preload);
  std::string others;
  for (std::string name; names >> name;) {
    if (name.find("roscpp_shim") == std::string::npos) {
      others += (others.empty() ? "" : " ") + name;
    }
  }
  if (others.empty()) {
    unsetenv("LD_PRELOAD");
  } else {
    setenv("LD_PRELOAD", others.c_str(), 1);
  }
}

bool isStarting() { return t_is_starting; }

void startRos(void (*start)()) {
  if (ros::isStarted() || !Node::isWanted()) {
    start();
    return;
  }
  const Inside inside;  // the threads that it starts are roscpp's own
  t_is_starting = true;
  start();
  t_is_starting = false;
  if (node().join()) {
    turn().begin();
  }
}

}  // namespace move_base_abstract::shim

namespace shim = move_base_abstract::shim;

namespace ros {

void start() {
  using Start = void();
  static Start* const function = shim::real<Start>("_ZN3ros5startEv");
  shim::startRos(function);
}

void shutdown() {
  using Shutdown = void();
  static Shutdown* const function = shim::real<Shutdown>("_ZN3ros8shutdownEv");
  shim::node().leave("ROS shuts down");
  const shim::Inside inside;
  function();
}

void waitForShutdown() {
  using WaitForShutdown = void();
  static WaitForShutdown* const function =
      shim::real<WaitForShutdown>("_ZN3ros15waitForShutdownEv");
  if (shim::turn().enter()) {
    shim::turn().wait(shim::Wait());
  }
  function();
}

}  // namespace ros
