#include "joining.h"

#include <XmlRpc.h>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/names.h>
#include <ros/param.h>
#include <ros/this_node.h>
#include <ros/time.h>
#include <ros/xmlrpc_manager.h>

#include <random>
#include <stdexcept>

#include "common/run_secret.h"

namespace move_base_abstract::lockstep::internal {
namespace {

constexpr double kRetrySeconds = wire::kConnectRetryMs * 1e-3;        // wall
constexpr double kReminderSeconds = wire::kConnectReminderMs * 1e-3;  // wall
const char* const kAddressParameter = "/time_master/lockstep_address";

void readRank(Presence* presence) {
  const std::string parameter = ros::names::resolve("~lockstep_rank");
  XmlRpc::XmlRpcValue value;
  if (!ros::param::get(parameter, value)) {
    return;
  }
  if (value.getType() != XmlRpc::XmlRpcValue::TypeInt) {
    throw Error("lockstep: parameter " + parameter + ": got " + value.toXml() +
                "; allowed: a whole number");
  }
  presence->rank = static_cast<int>(value);
}

void checkCharge() {
  const std::string parameter = ros::names::resolve("~lockstep_charge");
  std::string charge;
  if (ros::param::get(parameter, charge) && charge != "none") {
    throw Error("lockstep: parameter " + parameter + ": got '" + charge +
                "'; allowed in a roscpp node: 'none'");
  }
}

void checkMode(const std::string& name) {
  std::string mode;
  if (ros::param::get(kModeParameter, mode) && mode != kLockstepMode) {
    throw NotLockstep("lockstep: node " + name + " takes part in lockstep, but the time master's " +
                      kModeParameter + " is '" + mode + "', not '" + kLockstepMode + "'");
  }
}

/**
 * @return the run's secret; '' if there is none. @pre The time master is there: the parameters may
 * come with it. @throws std::invalid_argument, see runSecret().
 */
std::string secretOfRun() {
  std::string text, file;
  ros::param::get(kSecretParameter, text);
  ros::param::get(kSecretFileParameter, file);
  return runSecret(text, file);
}

}  // namespace

Presence readPresence(const std::optional<std::int32_t>& rank) {
  Presence presence;
  presence.name = ros::this_node::getName();
  presence.uri = ros::XMLRPCManager::instance()->getServerURI();
  presence.rank = rank;
  if (!rank) {
    readRank(&presence);
  }
  checkCharge();
  return presence;
}

bool connectToTimeMaster(const std::string& name, Link* link) {
  ros::WallTime warn_at = ros::WallTime::now() + ros::WallDuration(kReminderSeconds);
  while (ros::ok() && !ros::isShuttingDown()) {
    checkMode(name);
    std::string address;
    if (ros::param::get(kAddressParameter, address) && link->connect(address)) {
      return true;
    }
    if (ros::WallTime::now() > warn_at) {
      ROS_WARN("lockstep: %s waits for the time master (%s is %s)", name.c_str(), kAddressParameter,
               address.empty() ? "not set" : (address + ", where nobody listens").c_str());
      warn_at += ros::WallDuration(kReminderSeconds);
    }
    ros::WallDuration(kRetrySeconds).sleep();
  }
  return false;
}

std::string helloOf(const Presence& presence) {
  std::string secret;
  try {
    secret = secretOfRun();
  } catch (const std::invalid_argument& error) {
    throw Error("lockstep: node " + presence.name + ": parameter /time_master/" + error.what());
  }
  std::random_device random;
  wire::Hello hello;
  hello.name = presence.name;
  hello.node_uri = presence.uri;
  hello.rank = presence.rank.value_or(0);
  hello.rank_declared = presence.rank.has_value();
  hello.incarnation = (static_cast<std::uint64_t>(random()) << 32) | random();
  hello.secret = secret;
  return wire::encode(wire::ParticipantFrame(hello));
}

}  // namespace move_base_abstract::lockstep::internal
