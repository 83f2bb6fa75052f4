#include "radio_traffic.h"

#include <algorithm>

#include "clock/json_text.h"
#include "clock/number_text.h"

namespace move_base_abstract {

using radio::HostId;
using radio::Radio;

namespace {

// Robots report how they move when they begin. A robot that has not after this time [ns, simulated]
// probably never will.
constexpr Nanoseconds kTimeToTell = kNanosecondsPerSecond;

}  // namespace

RadioTraffic::RadioTraffic(radio::Network network, Nanoseconds lookahead, Voices voices)
    : radio_(std::move(network)),
      watch_(radio_.hosts()),
      lookahead_(lookahead),
      voices_(std::move(voices)) {}

void RadioTraffic::join(MemberId id, const std::string& name) { fresh_.emplace_back(name, id); }

/** @brief Give hosts to the members that have joined, in an order that is the same in every run. */
void RadioTraffic::settle(Nanoseconds now) {
  if (began_ && !is_said_ && now > *began_ + kTimeToTell) {
    is_said_ = true;
    sayWhatIsNot();  // before all actions of this instant, whichever call comes first
  }
  if (fresh_.empty()) {
    return;
  }
  std::sort(fresh_.begin(), fresh_.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? naturalLess(a.first, b.first) : a.second < b.second;
  });
  for (const auto& [name, id] : fresh_) {
    nodes_[id] = radio_.hosts().of(name);
    if (nodes_[id] == 0) {
      alone_.emplace_back(name, id);
    }
  }
  fresh_.clear();
  began_ = began_.value_or(now);
  watch_.advance(now);
  watch_.meet(now);
}

HostId RadioTraffic::hostOf(MemberId id, std::uint32_t sub) const {
  const auto robot = robots_.find({id, sub});
  if (robot != robots_.end()) {
    return robot->second;
  }
  const auto node = nodes_.find(id);
  return node == nodes_.end() ? 0 : node->second;
}

void RadioTraffic::move(MemberId id, const wire::Motion& motion, Nanoseconds now) {
  settle(now);
  const motion::Motion pieces(motion.pieces);
  const std::string robot(motion.robot);
  watch_.advance(now);
  if (robots_.count({id, motion.sub}) == 0) {
    const HostId own = radio_.hosts().of("/" + robot + "/move_base");
    robots_[{id, motion.sub}] = own != 0 ? own : hostOf(id, motion.sub);
  }
  const HostId host = radio_.hosts().move(robot, pieces);
  watch_.meet(now);
  if (host != 0) {
    watch_.moved(host, now);
    radio_.moved(host, now);
  }
  has_news_ = true;
}

bool RadioTraffic::isWired(std::string_view name) {
  const auto known = wired_.find(name);
  return known != wired_.end()
             ? known->second
             : wired_.emplace(std::string(name), radio_.hosts().network().isWired(name))
                   .first->second;
}

/**
 * @brief Label the run if the sender is on no host: its message to a host is not on the radio. A
 * node that only listens, such as a recorder, needs no host.
 */
void RadioTraffic::labelIfAlone(HostId from, std::string_view sender) {
  if (from == 0 && labelled_.insert(std::string(sender)).second) {
    voices_.label(quote(sender) +
                  " is on no host of the network: the messages that it sends are not on the radio");
  }
}

/**
 * @brief Report, once all robots have had the time to say how they move, what is not simulated:
 * hosts without a known place, hosts without nodes, and nodes on no host.
 */
void RadioTraffic::sayWhatIsNot() const {
  const radio::Hosts& hosts = radio_.hosts();
  for (HostId id = 1; id <= hosts.count(); ++id) {
    if (hosts.lacksPlace(id)) {
      voices_.label("host " + quote(hosts.name(id)) +
                    " of the network is out of reach wherever places matter: no robot of this name "
                    "tells how it moves (move_base and fleet of this package do); a fixed place "
                    "[x, y] is allowed, or links without a range and with a loss that is a number");
    }
  }
  for (const radio::HostRule& rule : hosts.network().hosts) {
    if (hosts.isWithoutNodes(rule)) {
      voices_.warn("host " + quote(rule.name) +
                   " of the network has none of the nodes that take "
                   "part: nothing of it is simulated");
    }
  }
  for (const auto& [name, id] : alone_) {
    const auto robot = robots_.lower_bound({id, 0});
    if (robot == robots_.end() || robot->first.first != id) {
      voices_.inform(
          quote(name) +
          " is on no host of the network: the messages that it gets are not on the radio");
    }
  }
}

Carried RadioTraffic::carry(const Passage& passage) {
  settle(passage.from);
  const HostId from = hostOf(passage.sender, passage.order.sub);
  const HostId to = hostOf(passage.receiver, passage.receiver_sub);
  if (from == to || isWired(passage.name)) {
    return {passage.from};
  }
  if (from == 0 || to == 0) {
    labelIfAlone(from, passage.sender_name);
    return {passage.from};
  }
  Sent sent{passage.order, {from, to}, std::string(passage.name), "["};
  for (const std::string_view name :
       {std::string_view(radio_.hosts().name(from)), std::string_view(radio_.hosts().name(to)),
        passage.sender_name, passage.receiver_name}) {
    appendJson(sent.values, name);
    sent.values += ",";
  }
  sent.values += std::to_string(passage.size) + "," + std::to_string(passage.from) + ",";
  const Radio::Outcome outcome = radio_.send(from, to, passage.size, ++ticket_, passage.from);
  if (outcome.kind == Radio::Outcome::Kind::kWaits) {
    waiting_.emplace(ticket_, std::move(sent));
    return {kNever, {}, ticket_};
  }
  return decided(sent, outcome, passage.from);
}

/**
 * @brief Note the outcome of a message, which was decided at @p now. With a lookahead, members may
 * already have gone so far that nothing can reach them before now + lookahead, so a message that
 * the radio brings sooner arrives then. In one direction of a link neither of these two instants
 * goes back from message to message, so the arrival does not, either.
 */
Carried RadioTraffic::decided(const Sent& sent, const Radio::Outcome& outcome, Nanoseconds now) {
  Counts& counts = counts_[std::minmax(sent.ends.first, sent.ends.second)];
  has_news_ = true;
  if (outcome.kind == Radio::Outcome::Kind::kLost) {
    ++counts.lost;
    voices_.tell(
        {sent.order, sent.name, "radio_lost", sent.values + "\"" + outcome.reason + "\"]"});
    return {outcome.at, outcome.reason};
  }
  ++counts.arrived;
  const Nanoseconds arrival = std::max(outcome.at, addSaturated(now, lookahead_));
  voices_.tell({sent.order, sent.name, "radio", sent.values + std::to_string(arrival) + "]"});
  return {arrival};
}

std::vector<std::pair<std::uint64_t, Carried>> RadioTraffic::look(Nanoseconds now) {
  std::vector<std::pair<std::uint64_t, Carried>> found;
  for (const Radio::Decided& one : radio_.look(now)) {
    const auto waiting = waiting_.find(one.ticket);
    if (waiting != waiting_.end()) {
      found.emplace_back(one.ticket, decided(waiting->second, one.outcome, now));
      waiting_.erase(waiting);
    }
  }
  return found;
}

std::vector<RadioTraffic::Change> RadioTraffic::changes(Nanoseconds now) {
  settle(now);
  watch_.advance(now);
  std::vector<Change> lines;
  for (const radio::LinkWatch::Change& change : watch_.take()) {
    std::string values = "[";
    appendJson(values, radio_.hosts().name(change.one));
    values += ",";
    appendJson(values, radio_.hosts().name(change.other));
    lines.push_back({change.at, "", "link", values + (change.is_up ? ",\"up\"]" : ",\"down\"]")});
    has_news_ = true;
  }
  while (told_ < radio_.hosts().count()) {
    ++told_;
    if (radio_.hosts().isFixed(told_)) {
      const radio::Place at = *radio_.hosts().place(told_, now);
      lines.push_back({now, radio_.hosts().name(told_), "host",
                       "[" + numberText(at.x) + "," + numberText(at.y) + "]"});
    }
  }
  return lines;
}

std::vector<LinkState> RadioTraffic::links(Nanoseconds now) const {
  std::vector<LinkState> links;
  const radio::Hosts& hosts = radio_.hosts();
  for (HostId other = 1; other <= hosts.count(); ++other) {
    for (HostId one = 1; one < other; ++one) {
      if (hosts.rule(one, other) == nullptr) {
        continue;
      }
      const auto counts = counts_.find({one, other});
      const auto from = hosts.place(one, now);
      const auto to = hosts.place(other, now);
      links.push_back({hosts.name(one), hosts.name(other), watch_.isUp(one, other),
                       counts == counts_.end() ? 0 : counts->second.arrived,
                       counts == counts_.end() ? 0 : counts->second.lost, from && to,
                       from.value_or(radio::Place{}), to.value_or(radio::Place{})});
    }
  }
  return links;
}

}  // namespace move_base_abstract
