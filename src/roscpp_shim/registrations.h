// The nodes, topics and services of the ROS master, as participants see them: the same in each run,
// in whichever order nodes registered.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include <array>
#include <map>
#include <set>
#include <string>

namespace move_base_abstract::shim {

/**
 * @brief The ROS master's publishers, subscribers and services that participants see.
 *
 * A node that does not take part is shown if it offers something besides what each node has. A node
 * that has left the run, or only looks on, is not shown.
 */
class Registrations {
 public:
  using Names = std::set<std::string>;
  using Group = std::map<std::string, Names>;  // nodes, by the name of a topic or service

  Registrations(const XmlRpc::XmlRpcValue& state, const Names& present, const Names& gone);

  /** @return publishers, subscribers and services; names and nodes are in the order of their bytes.
   */
  XmlRpc::XmlRpcValue state() const;
  /** @return those [topic, type] of @p pairs that a node publishes, or with @p also_heard that a
   * participant subscribes to, in order. */
  XmlRpc::XmlRpcValue topics(const XmlRpc::XmlRpcValue& pairs, bool also_heard) const;
  /** @return the shown nodes that do not take part. */
  Names strangers() const;
  /** @return the shown nodes that do not take part and publish a topic of @p pairs. */
  Names strangers(const XmlRpc::XmlRpcValue& pairs) const;
  /** @return whether @p node neither takes part nor is one that each system has (/rosout, the time
   * master). */
  bool isStranger(const std::string& node) const;

 private:
  Names present_;
  std::array<Group, 3> groups_;  // publishers, subscribers, services
};

}  // namespace move_base_abstract::shim
