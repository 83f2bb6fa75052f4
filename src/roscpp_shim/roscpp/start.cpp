// How roscpp programs begin and end.
#include <ros/console.h>
#include <ros/init.h>
#include <ros/this_node.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/fit.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/node.h"
#include "roscpp_shim/turn.h"

namespace move_base_abstract::shim {
namespace {

thread_local bool t_is_starting = false;

}  // namespace

bool isStarting() { return t_is_starting; }

/** @brief Log which versions this library fits; end the process if the program has others. */
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
  const Inside inside;  // the threads that start() makes are roscpp's own
  checkFit();
  lockstep::internal::watchForNamesake();
  t_is_starting = true;
  start();
  t_is_starting = false;
  if (node().join()) {
    tellWhatWasNoticed();
    turn().begin();
  }
}

}  // namespace move_base_abstract::shim

namespace ros {

// The texts that ROS keeps of names, ports and process numbers have other lengths in other runs.

void init(int& count, char** arguments, const std::string& name, uint32_t options) {
  static auto* const function = shim::real<void(int&, char**, const std::string&, uint32_t)>(
      "ros::init(int&, char**, string const&, unsigned)");
  const shim::Beside beside;
  function(count, arguments, name, options);
}

void init(const M_string& remappings, const std::string& name, uint32_t options) {
  static auto* const function = shim::real<void(const M_string&, const std::string&, uint32_t)>(
      "ros::init(map<string, string> const&, string const&, unsigned)");
  const shim::Beside beside;
  function(remappings, name, options);
}

void init(const VP_string& remappings, const std::string& name, uint32_t options) {
  static auto* const function = shim::real<void(const VP_string&, const std::string&, uint32_t)>(
      "ros::init(vector<pair<string, string>> const&, string const&, unsigned)");
  const shim::Beside beside;
  function(remappings, name, options);
}

void start() {
  static auto* const function = shim::real(&start, "ros::start");
  shim::startRos(function);
}

void shutdown() {
  static auto* const function = shim::real(&shutdown, "ros::shutdown");
  shim::node().leave("ROS shuts down");
  const shim::Inside inside;
  function();
}

void waitForShutdown() {
  static auto* const function = shim::real(&waitForShutdown, "ros::waitForShutdown");
  if (shim::turn().enter()) {
    shim::turn().wait(shim::Wait());
  }
  function();
}

}  // namespace ros
