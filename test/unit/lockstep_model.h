// What the time master has to do, written down a second time: slowly, with names and plain lists.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "lockstep/wire/wire.h"
#include "lockstep_items.h"
#include "lockstep_script.h"

namespace move_base_abstract {

/** @brief What a round grants: to whom (by place in the list of participants), when, with what. */
struct ExpectedRound {
  Nanoseconds time = 0;
  std::uint32_t microstep = 0;
  std::map<std::size_t, std::vector<std::string>> grants;  // items as texts

  std::string text() const {
    std::string all = std::to_string(time) + "+" + std::to_string(microstep) + ":";
    for (const auto& [node, items] : grants) {
      all += " " + std::to_string(node) + "[";
      for (const std::string& item : items) {
        all += item + "; ";
      }
      all += "]";
    }
    return all + "\n";
  }
};

class LockstepModel {
 public:
  LockstepModel(std::vector<ScriptNode> nodes, Nanoseconds start)
      : config_(std::move(nodes)), nodes_(config_.size()), time_(start) {}

  /** @brief The time master has got a whole frame. */
  void got(std::size_t node, std::string_view bytes) {
    auto frame = std::make_shared<const std::string>(bytes);
    const wire::ParticipantFrame decoded = wire::decodeFromParticipant(*frame);
    Node& state = nodes_[node];
    if (const auto* report = std::get_if<wire::Report>(&decoded)) {
      state.frame = frame;
      state.report = *report;
      state.owes = false;
      state.next = report->leaving ? kNever : report->next_ns;
      state.going = state.going || report->leaving;
    } else if (std::holds_alternative<wire::Hello>(decoded)) {
      state.there = true;
    } else if (std::holds_alternative<wire::Knock>(decoded)) {
      state.knocked = true;
    }
  }

  void lost(std::size_t node) {
    nodes_[node].owes = false;
    nodes_[node].next = kNever;
    nodes_[node].going = true;
  }

  bool anyOwes() const {
    return std::any_of(nodes_.begin(), nodes_.end(), [](const Node& node) { return node.owes; });
  }

  /** @return what has to be granted now; an empty round: nothing. */
  ExpectedRound decide() {
    const bool all = std::all_of(nodes_.begin(), nodes_.end(),
                                 [](const Node& node) { return node.there || node.gone; });
    if (anyOwes() || (!started_ && !all)) {
      return {};
    }
    apply();
    std::vector<std::size_t> granted;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      const Node& node = nodes_[k];
      if (node.there && (!started_ || !node.mail.empty() || node.knocked || node.next <= time_)) {
        granted.push_back(k);
      }
    }
    if (!started_) {
      started_ = true;
    } else if (!granted.empty()) {
      ++microstep_;
    } else if (!leap(granted)) {
      return {};
    }
    return grant(granted);
  }

  Nanoseconds time() const { return time_; }
  std::uint32_t microstep() const { return microstep_; }
  bool started() const { return started_; }
  const std::vector<std::string>& log() const { return log_; }

 private:
  using Key = std::tuple<std::int32_t, std::uint32_t, std::size_t, std::uint64_t>;
  static constexpr std::uint32_t kLast = std::numeric_limits<std::uint32_t>::max();

  struct Node {
    bool there = false;
    bool gone = false;
    bool going = false;
    bool owes = false;
    bool knocked = false;
    Nanoseconds next = kNever;
    std::uint64_t actions = 0;
    std::shared_ptr<const std::string> frame;
    wire::Report report;
    std::vector<std::pair<Key, std::string>> mail;
  };
  struct Closing {
    std::size_t receiver;
    Key key;
    std::string what;
    std::uint32_t topic;
    std::size_t publisher;
    std::size_t subscriber;
  };

  bool leap(std::vector<std::size_t>& granted) {
    Nanoseconds next = kNever;
    for (const Node& node : nodes_) {
      next = node.there ? std::min(next, node.next) : next;
    }
    if (next == kNever) {
      return false;
    }
    time_ = next;
    microstep_ = 0;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      if (nodes_[k].there && nodes_[k].next == next) {
        granted.push_back(k);
      }
    }
    return true;
  }

  ExpectedRound grant(const std::vector<std::size_t>& granted) {
    ExpectedRound round{time_, microstep_, {}};
    for (const std::size_t k : granted) {
      Node& node = nodes_[k];
      std::stable_sort(node.mail.begin(), node.mail.end(),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
      auto& items = round.grants[k];
      for (const auto& [key, text] : node.mail) {
        items.push_back(text);
      }
      node.mail.clear();
      node.owes = true;
      node.knocked = false;
      node.next = kNever;
    }
    return round;
  }

  void apply() {
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      order.push_back(k);
    }
    std::stable_sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) {
      return config_[a].rank < config_[b].rank;
    });
    std::vector<std::pair<Key, std::string>> log;
    for (const std::size_t k : order) {
      for (const wire::ReportItem& item : nodes_[k].report.items) {
        act(k, nodes_[k].actions++, item, log);
      }
      nodes_[k].report = {};
      if (nodes_[k].going && !nodes_[k].gone) {
        depart(k);
      }
    }
    for (const Closing& closing : closings_) {
      if (!linked(closing.topic, closing.publisher, closing.subscriber)) {
        post(closing.receiver, closing.key, closing.what);
      }
    }
    closings_.clear();
    greeted_.clear();
    std::sort(log.begin(), log.end());
    for (const auto& [key, text] : log) {
      log_.push_back(text);
    }
  }

  void act(std::size_t k, std::uint64_t number, const wire::ReportItem& item,
           std::vector<std::pair<Key, std::string>>& log) {
    if (const auto* a = std::get_if<wire::Advertise>(&item)) {
      publishers_[topicOf(a->topic)].push_back(k);
      for (const std::size_t other : subscribers_[topicOf(a->topic)]) {
        link(k, number, topicOf(a->topic), k, other);
      }
    } else if (const auto* b = std::get_if<wire::Subscribe>(&item)) {
      subscribers_[topicOf(b->topic)].push_back(k);
      for (const std::size_t other : publishers_[topicOf(b->topic)]) {
        link(k, number, topicOf(b->topic), other, k);
      }
    } else if (const auto* c = std::get_if<wire::Unadvertise>(&item)) {
      unadvertise(k, number, topicOf(c->topic));
    } else if (const auto* d = std::get_if<wire::Unsubscribe>(&item)) {
      unsubscribe(k, number, topicOf(d->topic));
    } else if (const auto* e = std::get_if<wire::Send>(&item)) {
      send(k, number, *e);
    } else if (const auto* f = std::get_if<wire::Log>(&item)) {
      log.push_back({key(k, f->sub, number), std::to_string(time_) + " " + std::string(f->robot) +
                                                 " " + std::string(f->kind) + " " +
                                                 std::string(f->values)});
    } else {
      actOnService(k, number, item);
    }
  }

  void actOnService(std::size_t k, std::uint64_t number, const wire::ReportItem& item) {
    if (const auto* a = std::get_if<wire::Serve>(&item)) {
      const std::uint32_t service = topicOf(a->service);
      servers_[service].push_back({k, a->sub});
      for (const std::size_t watcher : watchers_[service]) {
        post(watcher, key(k, a->sub, number), "found " + serviceName(service));
      }
      watchers_[service].clear();
    } else if (const auto* b = std::get_if<wire::Unserve>(&item)) {
      unserve(k, number, topicOf(b->service));
    } else if (const auto* c = std::get_if<wire::Watch>(&item)) {
      watch(k, number, serviceNumber(c->service));
    } else if (const auto* d = std::get_if<wire::Call>(&item)) {
      call(k, number, *d);
    } else if (const auto* e = std::get_if<wire::Response>(&item)) {
      respond(k, number, *e);
    }
  }

  void send(std::size_t k, std::uint64_t number, const wire::Send& item) {
    for (const std::size_t other : subscribers_[topicOf(item.topic)]) {
      if (item.target == 0 || item.target == other + 1) {
        post(other, key(k, item.sub, number),
             "deliver " + std::to_string(topicOf(item.topic)) + " " + std::to_string(k) + " " +
                 std::string(item.payload));
      }
    }
  }

  void call(std::size_t k, std::uint64_t number, const wire::Call& item) {
    const std::uint32_t service = serviceNumber(item.service);
    const std::string count = std::to_string(item.number);
    if (servers_[service].empty()) {
      return post(k, key(k, item.sub, number), "answer " + count + " 2");
    }
    const auto server = servers_[service].back();
    open_[{k, item.number}] = {server.first, server.second, service};
    post(server.first, key(k, item.sub, number),
         "call " + std::to_string(service) + " " + std::to_string(k) + " " + count);
  }

  void respond(std::size_t k, std::uint64_t number, const wire::Response& item) {
    const auto open = open_.find({item.caller - 1, item.number});
    if (open != open_.end() && std::get<0>(open->second) == k) {
      post(item.caller - 1, key(k, std::get<1>(open->second), number),
           "answer " + std::to_string(item.number) + (item.ok ? " 1" : " 0"));
      open_.erase(open);
    }
  }

  void watch(std::size_t k, std::uint64_t number, std::uint32_t service) {
    auto& watchers = watchers_[service];
    if (!servers_[service].empty()) {
      post(k, key(k, 0, number), "found " + serviceName(service));
    } else if (std::find(watchers.begin(), watchers.end(), k) == watchers.end()) {
      watchers.push_back(k);
    }
  }

  void unserve(std::size_t k, std::uint64_t number, std::uint32_t service) {
    auto& servers = servers_[service];
    servers.erase(std::remove_if(servers.begin(), servers.end(),
                                 [k](const auto& server) { return server.first == k; }),
                  servers.end());
    for (auto open = open_.begin(); open != open_.end();) {
      if (std::get<0>(open->second) == k && std::get<2>(open->second) == service) {
        post(open->first.first, key(k, kLast, number),
             "answer " + std::to_string(open->first.second) + " 3");
        open = open_.erase(open);
      } else {
        ++open;
      }
    }
  }

  void unadvertise(std::size_t k, std::uint64_t number, std::uint32_t topic) {
    if (!take(publishers_[topic], k)) {
      return;
    }
    for (const std::size_t other : subscribers_[topic]) {
      closings_.push_back({other, key(k, kLast, number),
                           "no publisher " + std::to_string(topic) + " " + std::to_string(k), topic,
                           k, other});
    }
  }

  void unsubscribe(std::size_t k, std::uint64_t number, std::uint32_t topic) {
    const auto& subscribers = subscribers_[topic];
    if (std::find(subscribers.begin(), subscribers.end(), k) == subscribers.end()) {
      return;
    }
    for (const std::size_t other : publishers_[topic]) {
      closings_.push_back({other, key(k, kLast, number),
                           "no subscriber " + std::to_string(topic) + " " + std::to_string(k),
                           topic, other, k});
    }
    take(subscribers_[topic], k);
  }

  void depart(std::size_t k) {
    for (std::uint32_t topic = 0; topic < kTopics; ++topic) {
      unadvertise(k, nodes_[k].actions, topic);
      unsubscribe(k, nodes_[k].actions, topic);
    }
    for (std::uint32_t service = 0; service < kServices; ++service) {
      unserve(k, nodes_[k].actions, service);
      take(watchers_[service], k);
    }
    for (auto open = open_.begin(); open != open_.end();) {
      open = open->first.first == k ? open_.erase(open) : std::next(open);
    }
    nodes_[k].there = false;
    nodes_[k].gone = true;
    nodes_[k].next = kNever;
    nodes_[k].knocked = false;
    nodes_[k].mail.clear();
  }

  void link(std::size_t by, std::uint64_t number, std::uint32_t topic, std::size_t publisher,
            std::size_t subscriber) {
    post(subscriber, key(by, 0, number),
         "publisher " + std::to_string(topic) + " " + std::to_string(publisher));
    if (greeted_.insert({publisher, topic, subscriber}).second) {  // once in a round
      post(publisher, key(by, 0, number),
           "subscriber " + std::to_string(topic) + " " + std::to_string(subscriber));
    }
  }

  bool linked(std::uint32_t topic, std::size_t publisher, std::size_t subscriber) {
    const auto& from = publishers_[topic];
    const auto& to = subscribers_[topic];
    return std::find(from.begin(), from.end(), publisher) != from.end() &&
           std::find(to.begin(), to.end(), subscriber) != to.end();
  }

  void post(std::size_t node, const Key& key, const std::string& text) {
    if (nodes_[node].there && !nodes_[node].going) {
      nodes_[node].mail.push_back({key, text});
    }
  }

  Key key(std::size_t k, std::uint32_t sub, std::uint64_t number) const {
    return {config_[k].rank, sub, k, number};
  }

  static bool take(std::vector<std::size_t>& list, std::size_t k) {
    const auto found = std::find(list.begin(), list.end(), k);
    if (found == list.end()) {
      return false;
    }
    list.erase(found);
    return true;
  }

  static std::uint32_t serviceNumber(std::string_view name) {
    return static_cast<std::uint32_t>(name.back() - '0');
  }

  const std::vector<ScriptNode> config_;
  std::vector<Node> nodes_;
  Nanoseconds time_;
  std::uint32_t microstep_ = 0;
  bool started_ = false;
  std::map<std::uint32_t, std::vector<std::size_t>> publishers_;   // by topic
  std::map<std::uint32_t, std::vector<std::size_t>> subscribers_;  // by topic
  std::set<std::tuple<std::size_t, std::uint32_t, std::size_t>> greeted_;
  std::map<std::uint32_t, std::vector<std::pair<std::size_t, std::uint32_t>>> servers_;
  std::map<std::uint32_t, std::vector<std::size_t>> watchers_;  // by service
  std::map<std::pair<std::size_t, std::uint32_t>,
           std::tuple<std::size_t, std::uint32_t, std::uint32_t>>
      open_;  // by caller and number: server, its sub, service
  std::vector<Closing> closings_;
  std::vector<std::string> log_;
};

}  // namespace move_base_abstract
