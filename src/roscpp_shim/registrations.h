// Who is there, of what the ROS master knows: the same in each run, whoever registered first.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_REGISTRATIONS_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_REGISTRATIONS_H

#include <xmlrpcpp/XmlRpcValue.h>

#include <array>
#include <map>
#include <set>
#include <string>

namespace move_base_abstract::shim {

/**
 * @brief What participants are shown of the ROS master's publishers, subscribers and services.
 *
 * Of nodes that take no part those are shown that offer something beside what each node has; who
 * has left the run, or only looks on, is not.
 */
class Registrations {
 public:
  using Names = std::set<std::string>;
  using Group = std::map<std::string, Names>;  // nodes, by the name of a topic or service

  Registrations(const XmlRpc::XmlRpcValue& state, const Names& present, const Names& gone);

  /** @return publishers, subscribers and services: names and nodes in the order of their bytes. */
  XmlRpc::XmlRpcValue state() const;
  /** @return those [topic, type] of @p pairs that somebody publishes, or a participant hears if
   * @p also_heard, in order. */
  XmlRpc::XmlRpcValue topics(const XmlRpc::XmlRpcValue& pairs, bool also_heard) const;
  /** @return the nodes shown that take no part. */
  Names strangers() const;
  /** @return those of them that publish any of the topics in @p pairs. */
  Names strangers(const XmlRpc::XmlRpcValue& pairs) const;
  /** @return whether it is none that each system has, from before the run on. */
  bool isStranger(const std::string& node) const;

 private:
  Names present_;
  std::array<Group, 3> groups_;  // publishers, subscribers, services
};

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_REGISTRATIONS_H
