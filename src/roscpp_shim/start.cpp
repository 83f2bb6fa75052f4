// Where roscpp programs begin and end.
#include <ros/console.h>
#include <ros/init.h>
#include <ros/this_node.h>

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

#include "fit.h"
#include "followed.h"
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

/** @brief Say what this library fits, and refuse what it does not. */
void checkFit() {
  const Surroundings found = lookAround();
  const std::string why = misfit(found);
  const std::string name = ros::this_node::getName();
  if (why.empty()) {
    ROS_INFO("lockstep: %s takes part with roscpp %s and glibc %s; what fits: %s", name.c_str(),
             found.roscpp_version.empty() ? "?" : found.roscpp_version.c_str(), found.glibc.c_str(),
             fitting().c_str());
  } else {
    ROS_FATAL("lockstep: %s cannot take part as it is: %s", name.c_str(), why.c_str());
    std::fflush(nullptr);
    std::_Exit(1);
  }
}

void startRos(void (*start)()) {
  if (ros::isStarted()) {
    start();
    return;
  }
  if (!Node::isWanted()) {
    stopFollowing();
    start();
    return;
  }
  beginToFollow();
  const Inside inside;  // the threads that it starts are roscpp's own
  checkFit();
  lockstep::internal::Membership::beforeRos();
  t_is_starting = true;
  start();
  t_is_starting = false;
  if (node().join()) {
    tellWhatWasNoticed();
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
