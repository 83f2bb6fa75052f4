#include "registrations.h"

#include <algorithm>
#include <iterator>

namespace move_base_abstract::shim {
namespace {

using XmlRpc::XmlRpcValue;
using Names = Registrations::Names;
using Group = Registrations::Group;

const Names kKnown = {"/rosout", "/time_master"};  // each system has them before the run
const std::string kOfEachNode = "/rosout";         // a topic that each node publishes
const std::array<std::string, 2> kServicesOfEachNode = {"/get_loggers", "/set_logger_level"};

bool endsIn(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

Group groupOf(const XmlRpcValue& entries) {
  Group group;
  for (int k = 0; k < entries.size(); ++k) {
    Names& nodes = group[entries[k][0]];
    for (int node = 0; node < entries[k][1].size(); ++node) {
      nodes.insert(entries[k][1][node]);
    }
  }
  return group;
}

/** @brief Keep only the nodes for which @p is_shown is true. */
template <class IsShown>
void keep(Group* group, IsShown is_shown) {
  for (auto entry = group->begin(); entry != group->end();) {
    Names& nodes = entry->second;
    for (auto node = nodes.begin(); node != nodes.end();) {
      node = is_shown(*node) ? std::next(node) : nodes.erase(node);
    }
    entry = nodes.empty() ? group->erase(entry) : std::next(entry);
  }
}

XmlRpcValue emptyArray() {
  XmlRpcValue array;
  array.setSize(0);
  return array;
}

XmlRpcValue arrayOf(const Group& group) {
  XmlRpcValue array = emptyArray();
  int k = 0;
  for (const auto& [name, nodes] : group) {
    XmlRpcValue list = emptyArray();
    int count = 0;
    for (const std::string& node : nodes) {
      list[count++] = node;
    }
    array[k][0] = name;
    array[k++][1] = list;
  }
  return array;
}

}  // namespace

Registrations::Registrations(const XmlRpcValue& state, const Names& present, const Names& gone)
    : present_(present) {
  for (int k = 0; k < 3 && k < state.size(); ++k) {
    groups_[static_cast<std::size_t>(k)] = groupOf(state[k]);
  }
  Names offering;
  for (const auto& [name, nodes] : groups_[0]) {
    if (name != kOfEachNode) {
      offering.insert(nodes.begin(), nodes.end());
    }
  }
  for (const auto& [name, nodes] : groups_[2]) {
    if (std::none_of(kServicesOfEachNode.begin(), kServicesOfEachNode.end(),
                     [&](const auto& end) { return endsIn(name, end); })) {
      offering.insert(nodes.begin(), nodes.end());
    }
  }
  const auto is_shown = [&](const std::string& node) {
    return !isStranger(node) || (offering.count(node) > 0 && gone.count(node) == 0);
  };
  keep(&groups_[0], is_shown);
  keep(&groups_[1], [this](const std::string& node) { return !isStranger(node); });
  keep(&groups_[2], is_shown);
}

bool Registrations::isStranger(const std::string& node) const {
  return present_.count(node) == 0 && kKnown.count(node) == 0;
}

XmlRpcValue Registrations::state() const {
  XmlRpcValue state;
  for (int k = 0; k < 3; ++k) {
    state[k] = arrayOf(groups_[static_cast<std::size_t>(k)]);
  }
  return state;
}

XmlRpcValue Registrations::topics(const XmlRpcValue& pairs, bool also_heard) const {
  std::map<std::string, std::string> types;
  for (int k = 0; k < pairs.size(); ++k) {
    const std::string topic = pairs[k][0];
    if (groups_[0].count(topic) > 0 || (also_heard && groups_[1].count(topic) > 0)) {
      types[topic] = static_cast<std::string>(pairs[k][1]);
    }
  }
  XmlRpcValue kept = emptyArray();
  int k = 0;
  for (const auto& [topic, type] : types) {
    kept[k][0] = topic;
    kept[k++][1] = type;
  }
  return kept;
}

Names Registrations::strangers() const {
  Names found;
  for (const std::size_t k : {std::size_t{0}, std::size_t{2}}) {
    for (const auto& entry : groups_[k]) {
      std::copy_if(entry.second.begin(), entry.second.end(), std::inserter(found, found.end()),
                   [this](const auto& node) { return isStranger(node); });
    }
  }
  return found;
}

Names Registrations::strangers(const XmlRpcValue& pairs) const {
  Names found;
  for (int k = 0; k < pairs.size(); ++k) {
    const auto entry = groups_[0].find(pairs[k][0]);
    if (entry != groups_[0].end()) {
      std::copy_if(entry->second.begin(), entry->second.end(), std::inserter(found, found.end()),
                   [this](const auto& node) { return isStranger(node); });
    }
  }
  return found;
}

}  // namespace move_base_abstract::shim
