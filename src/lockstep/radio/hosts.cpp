#include "hosts.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "patterns.h"

namespace move_base_abstract::radio {

HostId Hosts::of(std::string_view node) {
  for (const HostRule& rule : network_.hosts) {
    for (const std::string& pattern : rule.nodes) {
      if (const auto text = matched(pattern, node)) {
        return add(filled(rule.name, *text), rule);
      }
    }
  }
  return 0;
}

HostId Hosts::add(const std::string& name, const HostRule& rule) {
  const auto [known, fresh] = ids_.try_emplace(name, static_cast<HostId>(hosts_.size() + 1));
  if (fresh) {
    hosts_.push_back({name, &rule});
  }
  return known->second;
}

const LinkRule* Hosts::rule(HostId one, HostId other) const {
  const auto fits = [](const std::string& pattern, const std::string& host) {
    return matched(pattern, host).has_value();
  };
  for (const LinkRule& link : network_.links) {
    if ((fits(link.one, name(one)) && fits(link.other, name(other))) ||
        (fits(link.one, name(other)) && fits(link.other, name(one)))) {
      return &link;
    }
  }
  return nullptr;
}

HostId Hosts::move(const std::string& robot, const motion::Motion& motion) {
  motions_.insert_or_assign(robot, motion);
  const auto found = ids_.find(robot);
  return found == ids_.end() || hosts_[found->second - 1].rule->at ? 0 : found->second;
}

std::optional<Place> Hosts::place(HostId id, Nanoseconds now) const {
  const Host& host = hosts_[id - 1];
  if (host.rule->at) {
    return host.rule->at;
  }
  const auto motion = motions_.find(host.name);
  if (motion == motions_.end()) {
    return std::nullopt;
  }
  const motion::Pose pose = motion->second.poseAt(now);
  return Place{pose.x, pose.y};
}

Nanoseconds Hosts::standsFrom(HostId id) const {
  const Host& host = hosts_[id - 1];
  const auto motion = host.rule->at ? motions_.end() : motions_.find(host.name);
  return motion == motions_.end() ? 0 : motion->second.end();
}

bool Hosts::isWithoutNodes(const HostRule& rule) const {
  return std::none_of(hosts_.begin(), hosts_.end(),
                      [&rule](const Host& host) { return host.rule == &rule; });
}

bool Hosts::lacksPlace(HostId id) const {
  if (place(id, 0)) {
    return false;
  }
  for (HostId other = 1; other <= count(); ++other) {
    const LinkRule* const link = other == id ? nullptr : rule(id, other);
    if (link != nullptr && link->needsPlaces()) {
      return true;
    }
  }
  return false;
}

/** If places matter, a host whose place is not known is out of reach. */
Hosts::Reach Hosts::reach(const LinkRule& rule, HostId one, HostId other, Nanoseconds now) const {
  if (!rule.needsPlaces()) {
    const double loss = std::get<double>(rule.loss);
    return {loss < 1.0, loss, true};
  }
  const auto from = place(one, now);
  const auto to = place(other, now);
  if (!from || !to) {
    return {false, 1.0, false};
  }
  const double dx = to->x - from->x;
  const double dy = to->y - from->y;
  double distance = std::sqrt(dx * dx + dy * dy);
  if (distance > rule.range) {
    return {false, 1.0, true};
  }
  const double walls = rule.wall > 0.0 ? rule.wall * network_.walls.between(*from, *to) : 0.0;
  if (!std::holds_alternative<PathLoss>(rule.loss)) {
    distance += walls;
  }
  if (distance > rule.range) {
    return {false, 1.0, true};
  }
  const double loss = lossAt(rule.loss, distance, walls);
  return {loss < 1.0, loss, true};
}

}  // namespace move_base_abstract::radio
