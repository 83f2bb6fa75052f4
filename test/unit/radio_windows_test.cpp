// The radio with a lookahead: what it brings sooner comes when that is over, what it brings later
// comes at its own instant, wherever windows begin and however far each goes by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "broken.h"
#include "lockstep/radio/radio.h"
#include "lockstep_items.h"
#include "lockstep_walkers.h"
#include "radio_motion.h"

namespace move_base_abstract::radio_windows_test {
namespace {

using Texts = std::vector<std::string>;
using radio::HostId;
using Kind = radio::Radio::Outcome::Kind;

/** @brief The radio by itself, and when what it brings is there: no session, no windows. */
struct PlainAir {
  explicit PlainAir(const Texts& lines, std::size_t count) : radio(radio::networkOf(lines)) {
    for (std::size_t k = 0; k < count; ++k) {
      hosts.push_back(radio.hosts().of("/n" + std::to_string(k)));
    }
  }
  void send(std::size_t from, std::size_t to, const Message& message, Nanoseconds now) {
    sent.push_back({from, to, message});
    if (hosts[from] == hosts[to]) {
      return take({Kind::kArrives, now, nullptr}, sent.size(), now, 1);
    }
    take(radio.send(hosts[from], hosts[to], message.size(), sent.size(), now), sent.size(), now, 1);
  }
  void look(Nanoseconds now) {
    for (const radio::Radio::Decided& one : radio.look(now)) {
      take(one.outcome, one.ticket, now, 0);
    }
  }
  void take(const radio::Radio::Outcome& outcome, radio::Ticket ticket, Nanoseconds now,
            int is_new) {
    if (outcome.kind == Kind::kArrives) {
      const auto& [from, to, message] = sent[ticket - 1];
      const Nanoseconds at = std::max(outcome.at, now + kAhead);
      // What was on its way before comes first; then as it was sent.
      arrivals.insert({at, to, at == now + kAhead ? is_new : 0, from, ticket, message});
    }
  }
  Nanoseconds next() const {
    return std::min(radio.nextLook(), arrivals.empty() ? kNever : std::get<0>(*arrivals.begin()));
  }
  std::vector<Message> heard(std::size_t by, Nanoseconds now) {
    std::vector<Message> found;
    while (!arrivals.empty() && std::get<0>(*arrivals.begin()) == now &&
           std::get<1>(*arrivals.begin()) == by) {
      found.push_back(std::get<5>(*arrivals.begin()));
      arrivals.erase(arrivals.begin());
    }
    return found;
  }

  radio::Radio radio;
  std::vector<HostId> hosts;
  std::vector<std::tuple<std::size_t, std::size_t, Message>> sent;
  std::set<std::tuple<Nanoseconds, std::size_t, int, std::size_t, radio::Ticket, Message>> arrivals;
};

/** @return what each hears, and when: an exact queue of events. */
Texts byHand(std::vector<Actor> actors, const Texts& network) {
  PlainAir air(network, actors.size());
  Texts log;
  while (true) {
    Nanoseconds now = air.next();
    for (const Actor& actor : actors) {
      now = actor.ticks > 0 ? std::min(now, actor.next) : now;
    }
    if (now == kNever) {
      return log;
    }
    air.look(now);
    for (std::size_t k = 0; k < actors.size(); ++k) {
      std::vector<Message> told;
      for (const Message& heard : air.heard(k, now)) {
        log.push_back(line(now, actors[k].name, heard));
        told.push_back(relayed(heard, actors[k]));
      }
      if (actors[k].ticks > 0 && actors[k].next == now) {
        told.push_back("1 " + actors[k].name.substr(1) + "-" + std::to_string(actors[k].made++));
        actors[k].next += actors[k].period;
        --actors[k].ticks;
      }
      for (const Message& message : told) {
        for (std::size_t other = 0; other < actors.size() && !message.empty(); ++other) {
          air.send(k, other, message, now);
        }
      }
    }
  }
}

Texts heardOf(const Texts& log) {
  Texts heard;
  std::copy_if(log.begin(), log.end(), std::back_inserter(heard),
               [](const std::string& one) { return one.substr(one.size() - 3) == " []"; });
  return heard;
}

TEST(RadioWindows, RandomRunsAreThoseOfARadioWithoutWindows) {
  const char* const links[] = {
      "delay 20000000 200000000 loss 0.3 rate 20000",
      "delay 10000000 60000000 loss 0.4 lost retry retry 30000000 attempts 3",
      "delay 70000000 70000000 loss 0.3 lost queue retry 45000000 rate 8000",
      "delay 50000000 50000000"};
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const std::vector<Actor> actors = randomActors(seed);
    const Texts network = {"seed " + std::to_string(seed), "host both at 0 0 /n0 /n3",
                           "host h* at 10 0 /n*",
                           "link * * " + std::string(links[seed % std::size(links)])};
    const Texts expected = byHand(actors, network);
    ASSERT_GT(expected.size(), 10U);
    const Texts once = Walkers(actors, seed * 2, network).run();
    ASSERT_EQ(heardOf(once), expected) << seed;
    ASSERT_EQ(Walkers(actors, seed * 2 + 1, network).run(), once) << seed;
  }
}

TEST(RadioWindows, TheirRulesAreMissedWhereTheyAreBroken) {
  const auto runs = [] {
    std::vector<Texts> found;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      found.push_back(
          Walkers(randomActors(seed), seed,
                  {"seed 1", "host h* at 10 0 /n*",
                   "link * * delay 20000000 200000000 loss 0.2 lost retry retry 30000000"})
              .run());
    }
    return found;
  };
  const std::vector<Texts> whole = runs();
  for (const char* rule : {"radio_lookahead_in_the_log", "radio_before_what_is_done_then"}) {
    const Broken broken(rule);
    EXPECT_NE(runs(), whole) << rule;
  }
}

/** @brief /base tells news and calls, /robot_1/ear listens and answers; it is 1200 ms. */
struct Pair2 : Stage {
  explicit Pair2(const std::string& link, const std::string& robot = "at 10 0")
      : Stage(settings(link, robot)) {
    join(1, "/base");
    join(2, "/robot_1/ear");
    grant(1);
    grant(2);
    report(1, 1200 * kMilli, {advertise(1, "/news")});
    report(2, 1200 * kMilli, {subscribe(1, "/news"), wire::Serve{1, 0, "/do"}});
    told(1);  // of the link
    told(2);
    report(1, 1200 * kMilli);
    report(2, 1200 * kMilli);
    log();
    told(1);
    told(2);
  }
  static LockstepSettings settings(const std::string& link, const std::string& robot) {
    LockstepSettings found =
        ahead({"/base", "/robot_1/ear"},
              {"host base at 0 0 /base", "host robot_* " + robot + " /robot_*/**",
               "link base robot_* " + link});
    found.log_messages = true;
    return found;
  }
  /** @brief Do this at 1200 ms. */
  void begin(const std::vector<wire::ReportItem>& base,
             const std::vector<wire::ReportItem>& ear = {}, std::uint32_t open = 0) {
    report(1, kNever, base, open);
    report(2, kNever, ear);
  }
  /** @return the grants of @p id, without what says where the window ends; the instants in us. */
  Texts told(ConnectionId id) {
    Texts texts;
    while (const auto one = grant(id)) {
      std::string text = std::to_string(one->grant.time_ns / 1000);
      for (const wire::GrantItem& item : one->grant.items) {
        text += std::holds_alternative<wire::Window>(item) ? "" : " " + itemText(item);
      }
      texts.push_back(text);
    }
    return texts;
  }
  Texts log() {
    Texts texts;
    for (const LockstepLogEntry& entry : session.takeLog()) {
      texts.push_back(std::to_string(entry.time / 1000) + " " + entry.kind + " " + entry.values);
    }
    return texts;
  }
};

const wire::Send kNews{1, 0, 0, "x"};

TEST(RadioWindows, WhatTheRadioBringsSoonerComesWhenTheLookaheadIsOver) {
  Pair2 pair("delay 20000000 20000000");
  pair.begin({kNews});
  EXPECT_EQ(pair.told(2), Texts{"1250000 deliver 1 1 x"});
  EXPECT_EQ(pair.log()[1],
            R"(1200000 radio ["base","robot_1","/base","/robot_1/ear",1,1200000000,1250000000])");
}

TEST(RadioWindows, WhatItBringsLaterComesAtItsOwnInstantInTheMiddleOfAWindow) {
  Pair2 pair("delay 70500000 70500000");
  pair.begin({kNews, kNews});
  EXPECT_EQ(pair.told(2), Texts{"1270500 deliver 1 1 x deliver 1 1 x"});
  const Texts log = pair.log();
  EXPECT_EQ(log[0],
            R"(1200000 radio ["base","robot_1","/base","/robot_1/ear",1,1200000000,1270500000])");
  EXPECT_EQ(log[2].substr(0, 15), "1220500 message");  // a lookahead before it is there
}

TEST(RadioWindows, TimeDoesNotStandStillWhileSomethingIsUnderWay) {
  Pair2 pair("delay 5000000000 5000000000");
  pair.begin({kNews});
  EXPECT_EQ(pair.phase(), "running");
  EXPECT_EQ(pair.told(2), Texts{"6200000 deliver 1 1 x"});
}

TEST(RadioWindows, ACallAndItsAnswerPassTheLinkAndALostOneFailsWhenTheLookaheadIsOver) {
  Pair2 pair("delay 70000000 70000000");
  pair.begin({wire::Call{5, 0, "/do", "?"}}, {}, 1);
  EXPECT_EQ(pair.told(2), Texts{"1270000 call 1 1 5"});
  pair.report(2, kNever, {wire::Response{1, 5, true, "!"}});
  EXPECT_EQ(pair.told(1), Texts{"1340000 answer 5 1"});
  Pair2 lost("range 9");
  lost.begin({wire::Call{5, 0, "/do", "?"}}, {}, 1);
  EXPECT_EQ(lost.told(2), Texts());
  const auto gone = std::to_string(static_cast<int>(wire::CallStatus::kServerGone));
  EXPECT_EQ(lost.told(1), Texts{"1250000 answer 5 " + gone});
}

TEST(RadioWindows, WhatIsUnderWayWhenItsLinkClosesIsLostUnlessTheWordOfItComesLater) {
  for (const auto& [delay, arrives] :
       {std::pair("160000000", false), std::pair("140000000", true)}) {
    Pair2 pair("delay " + std::string(delay) + " " + delay);
    pair.report(1, kNever, {kNews});
    pair.report(2, 1300 * kMilli);
    EXPECT_EQ(pair.told(2), Texts{arrives ? "1300000 at 1340000000 deliver 1 1 x" : "1300000"});
    pair.report(2, 1500 * kMilli, {wire::Unsubscribe{1}});
    pair.told(1);  // of the link
    pair.report(1, kNever);
    EXPECT_EQ(pair.told(2), Texts{"1500000"});
    pair.report(2, kNever);
    const Texts log = pair.log();
    EXPECT_EQ(log.back().substr(0, 12), arrives ? "1290000 mess" : "1300000 lost");
  }
}

TEST(RadioWindows, AQueueKeepsItUntilTheRobotComesIntoRange) {
  Pair2 pair("range 5 lost queue delay 3 3", "robot");
  const std::string drive = piece(1200 * kMilli, 10.0, -2.0) + piece(5200 * kMilli, 2.0, 0.0);
  pair.begin({kNews}, {wire::Motion{0, "robot_1", drive}});
  EXPECT_EQ(pair.told(2), Texts{"3750000 deliver 1 1 x"});
  const Texts log = pair.log();
  EXPECT_EQ(log[0], R"(3700000 link ["base","robot_1","up"])");
  EXPECT_EQ(log[2],
            R"(3700000 radio ["base","robot_1","/base","/robot_1/ear",1,1200000000,3750000000])");
}

TEST(RadioWindows, ATargetHoldsBackWhatTheRadioDoesAfterIt) {
  Pair2 pair("range 5 lost queue", "robot");
  pair.session.runUntil(2000 * kMilli);
  const std::string drive = piece(1200 * kMilli, 10.0, -2.0) + piece(5200 * kMilli, 2.0, 0.0);
  pair.begin({kNews}, {wire::Motion{0, "robot_1", drive}});
  EXPECT_EQ(pair.told(2), Texts());
  EXPECT_EQ(pair.session.now(), 2000 * kMilli);
  EXPECT_EQ(pair.phase(), "paused");
  pair.session.resume();
  pair.poll();
  EXPECT_EQ(pair.told(2), Texts{"3750000 deliver 1 1 x"});
}

}  // namespace
}  // namespace move_base_abstract::radio_windows_test
