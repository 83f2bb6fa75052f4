#include "interruption.h"

#include <algorithm>

namespace move_base_abstract {

void Interruption::begin(MemberId id, ConnectionId connection, Nanoseconds wall, bool at_rest) {
  rested_ = active_ ? rested_ : at_rest;
  active_ = true;
  last_ = wall;
  concerned_.insert({id, {connection, wall, false}});
}

void Interruption::knocked(MemberId id) {
  const auto found = concerned_.find(id);
  if (found != concerned_.end()) {
    found->second.knocked = true;
  }
}

void Interruption::lost(ConnectionId connection, Nanoseconds wall) {
  for (auto& [id, concerned] : concerned_) {
    if (concerned.connection == connection) {
      concerned.connection = 0;
      last_ = wall;
    }
  }
}

std::map<MemberId, Nanoseconds> Interruption::ending() const {
  std::map<MemberId, Nanoseconds> ending;
  for (const auto& [id, concerned] : concerned_) {
    if (concerned.connection != 0) {
      ending[id] = concerned.since;
    }
  }
  return ending;
}

Nanoseconds Interruption::due() const {
  if (!active_) {
    return kNever;
  }
  // A program that ends several processes may wait for one of them before it ends the next.
  const bool ending = std::any_of(concerned_.begin(), concerned_.end(), [](const auto& entry) {
    return entry.second.connection != 0 && !entry.second.knocked;
  });
  return last_ + (ending ? kPatience : kGrace);
}

std::vector<Interruption::Label> Interruption::finish() {
  active_ = false;
  concerned_.clear();
  return std::exchange(labels_, {});
}

}  // namespace move_base_abstract
