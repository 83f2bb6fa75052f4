// Participants that do random things, but always the same ones after the same grants.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "lockstep/wire/wire.h"

namespace move_base_abstract {

/** @brief One participant of a test; those of one rank are listed in their natural order. */
struct ScriptNode {
  std::string name;
  std::int32_t rank;
  std::uint32_t robots;  // sends as sub 0 to robots - 1
};

constexpr std::uint32_t kTopics = 3;
constexpr std::uint32_t kServices = 2;

inline std::string topicName(std::uint32_t topic) { return "/topic_" + std::to_string(topic); }
inline std::string serviceName(std::uint32_t service) {
  return "/service_" + std::to_string(service);
}
/** @brief Participants number as they please; here all differently. */
inline std::uint32_t ownNumber(std::size_t node, std::uint32_t topic) {
  return static_cast<std::uint32_t>(100 * (node + 1)) + topic;
}
inline std::uint32_t topicOf(std::uint32_t own_number) { return own_number % 100; }

class Script {
 public:
  Script(std::size_t index, const ScriptNode& node, std::uint64_t seed, int grants)
      : index_(index), node_(node), state_(seed * 1000003 + index), grants_left_(grants) {}

  /** @return the whole frame of the report. Everything depends on what was granted, and on order.
   */
  std::string answer(const wire::Grant& grant) {
    items_.clear();
    stir(static_cast<std::uint64_t>(grant.time_ns) + grant.microstep);
    for (const wire::GrantItem& item : grant.items) {
      stir(item.index());
      std::visit([this](const auto& value) { take(value); }, item);
    }
    wire::Report head;
    head.round = grant.round;
    if (grants_left_-- > 0) {
      act(first_);
      head.next_ns = nextWake(grant.time_ns);
      head.leaving = may_leave && grants_left_ < 3 && below(4) == 0;
      first_ = false;
    }
    return wire::encodeReport(head, items_);
  }

  bool may_leave = false;

 private:
  void stir(std::uint64_t value) { state_ = (state_ ^ value) * 0x9E3779B97F4A7C15U + 12345; }

  std::uint32_t below(std::uint32_t end) {
    stir(1);
    return static_cast<std::uint32_t>((state_ >> 33U) % end);
  }

  void add(const wire::ReportItem& item) { wire::append(items_, item); }

  void take(const wire::Publisher& item) { stir(item.sender); }
  void take(const wire::NoPublisher& item) { stir(item.sender); }
  void take(const wire::NoSubscriber& item) { stir(item.receiver); }
  void take(const wire::Subscriber& item) {
    const std::uint32_t topic = topicOf(item.topic);
    if (topic == 0 && advertised_.count(topic) != 0) {  // topic 0 is latched
      add(wire::Send{item.topic, 0, item.receiver, "latched"});
    }
  }
  void take(const wire::Deliver& item) {
    stir(item.sender);
    for (const char c : item.payload) {
      stir(static_cast<unsigned char>(c));
    }
  }
  void take(const wire::CallIn& item) {
    calls_.push_back({item.caller, item.number});
    stir(item.caller);
  }
  void take(const wire::Answer& item) {
    stir(item.number + static_cast<std::uint64_t>(item.status));
  }
  void take(const wire::Found&) {}
  void take(const wire::Window&) {}
  void take(const wire::Arrives&) {}
  void take(const wire::Came&) {}
  void take(const wire::Changed&) {}
  void take(const wire::Happened&) {}
  void take(const wire::DeliveryChosen&) {}

  void act(bool first) {
    for (std::uint32_t k = first ? 4 : below(2) * below(4); k > 0; --k) {
      actOnce(first ? below(4) : below(11));
    }
    while (!calls_.empty() && below(4) != 0) {
      const auto [caller, number] = calls_.front();
      calls_.pop_front();
      const std::string text = "answer " + std::to_string(number);
      add(wire::Response{caller, number, below(5) != 0, text});
    }
  }

  void actOnce(std::uint32_t what) {
    const std::uint32_t topic = below(kTopics);
    const std::uint32_t sub = below(node_.robots);
    switch (what) {
      case 0:
        return advertise(topic, sub);
      case 1:
      case 2:
        return subscribe(topic, sub);
      case 3:
        return serve(below(kServices), sub);
      case 4:
        return call(sub);
      case 5:
        return add(wire::Log{sub, "robot_" + std::to_string(sub), "seen", "[1]"});
      case 6:
        return stop(topic);
      default:
        return send(topic, sub);
    }
  }

  void advertise(std::uint32_t topic, std::uint32_t sub) {
    if (advertised_.insert(topic).second) {
      add(wire::Advertise{ownNumber(index_, topic), sub, topicName(topic), "test/Type", "md5",
                          topic == 0, "definition"});
    }
  }

  void subscribe(std::uint32_t topic, std::uint32_t sub) {
    if (subscribed_.insert(topic).second) {
      add(wire::Subscribe{ownNumber(index_, topic), sub, topicName(topic),
                          below(2) == 0 ? "*" : "md5"});
    }
  }

  void serve(std::uint32_t service, std::uint32_t sub) {
    if (served_.insert(service).second) {
      add(wire::Serve{ownNumber(index_, service), sub, serviceName(service)});
    } else if (below(3) == 0) {
      served_.erase(service);
      add(wire::Unserve{ownNumber(index_, service)});
    }
  }

  void call(std::uint32_t sub) {
    const std::string service = serviceName(below(kServices));
    if (below(5) == 0) {
      add(wire::Watch{service});
    }
    add(wire::Call{next_call_, sub, service, "request"});
    ++next_call_;
  }

  void stop(std::uint32_t topic) {
    if (below(2) == 0 && advertised_.erase(topic) != 0) {
      add(wire::Unadvertise{ownNumber(index_, topic)});
    } else if (subscribed_.erase(topic) != 0) {
      add(wire::Unsubscribe{ownNumber(index_, topic)});
    }
  }

  void send(std::uint32_t topic, std::uint32_t sub) {
    advertise(topic, sub);
    ++sent_;
    const std::string payload = std::string(below(3), 'x') + std::to_string(sent_);
    add(wire::Send{ownNumber(index_, topic), sub, 0, payload});
  }

  Nanoseconds nextWake(Nanoseconds now) {
    switch (below(10)) {
      case 0:
        return now;
      case 1:
        return now - 10;  // already past: due now
      case 2:
        return kNever;
      default:
        return now + 10 * static_cast<Nanoseconds>(1 + below(3));  // wake-ups often coincide
    }
  }

  const std::size_t index_;
  const ScriptNode node_;
  std::uint64_t state_;
  int grants_left_;
  bool first_ = true;
  std::string items_;
  std::set<std::uint32_t> advertised_;
  std::set<std::uint32_t> subscribed_;
  std::set<std::uint32_t> served_;
  std::deque<std::pair<std::uint32_t, std::uint32_t>> calls_;
  std::uint32_t next_call_ = 0;
  int sent_ = 0;
};

}  // namespace move_base_abstract
