// Programs that go through windows as far as chance has them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lockstep_client.h"
#include "roscpp_shim/membership/window.h"

namespace move_base_abstract {

constexpr Nanoseconds kMilli = 1'000'000;
constexpr Nanoseconds kAhead = 50 * kMilli;

inline LockstepSettings ahead(std::vector<std::string> names,
                              const std::vector<std::string>& network = {}) {
  LockstepSettings settings = named(std::move(names));
  settings.lookahead = 0.05;
  settings.network = network;
  return settings;
}

/** @brief What a program of the random runs does: the same in the session and by hand. */
struct Actor {
  std::string name;
  Nanoseconds period;
  Nanoseconds next;
  int ticks;
  int made = 0;
};

using Message = std::string;  // "HOPS SENDER-COUNT"

inline std::string relayed(const Message& heard, const Actor& by) {
  const int hops = heard[0] - '0';
  return hops == 0 ? "" : std::to_string(hops - 1) + " " + by.name.substr(1) + heard.substr(1);
}

inline std::vector<Actor> randomActors(std::uint64_t seed) {
  std::mt19937_64 chance(seed);
  std::vector<Actor> actors;
  const std::size_t count = 2 + chance() % 3;
  for (std::size_t k = 0; k < count; ++k) {
    const Nanoseconds period = static_cast<Nanoseconds>(1 + chance() % 12) * 10 * kMilli;
    const auto first = static_cast<Nanoseconds>(chance() % 20) * 5 * kMilli;
    actors.push_back({"/n" + std::to_string(k), period, 1200 * kMilli + first, 6});
  }
  return actors;
}

inline std::string line(Nanoseconds now, const std::string& name, const std::string& what) {
  return std::to_string(now / kMilli) + " " + name + " " + what + " []";
}

/** @brief The same programs as participants, which go through windows as far as chance has them. */
struct Walkers : Stage {
  Walkers(std::vector<Actor> all, std::uint64_t seed, const std::vector<std::string>& network = {})
      : Stage(ahead(namesOf(all), network)),
        actors(std::move(all)),
        windows(actors.size()),
        chance(seed) {
    for (std::size_t k = actors.size(); k > 0; --k) {  // not in the order of their names
      join(k, actors[k - 1].name);
    }
  }

  static std::vector<std::string> namesOf(const std::vector<Actor>& actors) {
    std::vector<std::string> names;
    for (const Actor& actor : actors) {
      names.push_back(actor.name);
    }
    return names;
  }

  std::vector<std::string> run() {
    std::vector<std::string> log;
    bool is_over = false;
    while (!is_over) {
      is_over = !goOn();
      std::vector<std::size_t> order(actors.size());
      for (std::size_t k = 0; k < order.size(); ++k) {
        order[k] = k;
      }
      std::shuffle(order.begin(), order.end(), chance);
      for (const std::size_t k : order) {
        if (auto granted = grant(k + 1)) {
          is_over = false;
          walk(k, granted->grant);
        }
      }
      for (const std::string& one : lines(session)) {
        log.push_back(one);
      }
    }
    return log;
  }

  /** @brief Leave a stop, if it stands at one, and stop again soon. @return whether it stood. */
  bool goOn() {
    const bool stood = phase() == "stopped";
    if (may_stop && chance() % 2 == 0) {
      StopCondition condition;
      condition.what = chance() % 2 == 0 ? StopCondition::What::kRow : condition.what;
      condition.count = chance() % 3;
      session.stopWhen(condition);
      poll();
    } else if (stood) {
      session.resume();
      poll();
    }
    return stood;
  }

  void walk(std::size_t k, wire::Grant grant) {
    auto& window = windows[k];
    EXPECT_TRUE(window.take(&grant));
    texts.clear();
    std::vector<wire::ReportItem> done;
    Nanoseconds now = grant.time_ns;
    if (now == kSecond) {
      done = {advertise(1, "/t"), subscribe(1, "/t")};
    }
    std::string kept = window.arrived(now);
    turn(k, now, kept, &done);
    turn(k, now, grant.items, &done);
    tick(k, now, &done);
    while (chance() % 4 != 0) {
      const Nanoseconds next = window.next(wish(k), now);
      if (next == kNever) {
        break;
      }
      now = next;
      done.push_back(wire::At{now});
      kept = window.arrived(now);
      turn(k, now, kept, &done);
      tick(k, now, &done);
    }
    report(k + 1, std::min(wish(k), window.firstArrival()), done);
  }

  void turn(std::size_t k, Nanoseconds now, const std::string& frame,
            std::vector<wire::ReportItem>* done) {
    if (!frame.empty()) {
      turn(k, now, std::get<wire::Grant>(wire::decodeFromMaster(frame)).items, done);
    }
  }

  void turn(std::size_t k, Nanoseconds, const std::vector<wire::GrantItem>& items,
            std::vector<wire::ReportItem>* done) {
    for (const wire::GrantItem& item : items) {
      if (const auto* heard = std::get_if<wire::Deliver>(&item)) {
        done->push_back(wire::Log{0, actors[k].name, keep(std::string(heard->payload)), "[]"});
        say(relayed(std::string(heard->payload), actors[k]), done);
      }
    }
  }

  void tick(std::size_t k, Nanoseconds now, std::vector<wire::ReportItem>* done) {
    Actor& actor = actors[k];
    if (actor.ticks > 0 && actor.next == now) {
      say("1 " + actor.name.substr(1) + "-" + std::to_string(actor.made++), done);
      actor.next += actor.period;
      --actor.ticks;
    }
  }

  void say(const std::string& message, std::vector<wire::ReportItem>* done) {
    if (!message.empty()) {
      done->push_back(wire::Send{1, 0, 0, keep(message)});
    }
  }

  std::string_view keep(const std::string& text) { return texts.emplace_back(text); }
  Nanoseconds wish(std::size_t k) const { return actors[k].ticks > 0 ? actors[k].next : kNever; }

  bool may_stop = false;
  std::vector<Actor> actors;
  std::vector<lockstep::internal::Window> windows;
  std::mt19937_64 chance;
  std::deque<std::string> texts;
};

}  // namespace move_base_abstract
