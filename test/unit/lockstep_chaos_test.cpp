// Another legal order of equal events: what must stay, whatever the seed, and that a seed is one
// run.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "broken.h"
#include "lockstep/chaos/chaos.h"
#include "lockstep/chaos/decisions.h"
#include "lockstep/chaos/draws.h"
#include "lockstep_client.h"
#include "lockstep_items.h"

namespace move_base_abstract::lockstep_chaos_test {
namespace {

using Texts = std::vector<std::string>;
using Items = std::vector<wire::ReportItem>;

constexpr ConnectionId kMembers = 4;
constexpr std::uint32_t kTopics = 3;  // each member's own, and all listen to all
constexpr Nanoseconds kStep = kSecond / 10;
constexpr int kSteps = 12;

LockstepSettings chaotic(std::uint32_t seed, double delay = 0.0, const std::string& only = "") {
  LockstepSettings settings = named({"/a", "/b", "/c", "/d"});
  settings.log_messages = true;
  settings.chaos_seed = seed;
  settings.chaos_delay = delay;
  settings.chaos_only = only;
  settings.keeps_decisions = true;
  return settings;
}

std::uint32_t topicNumber(ConnectionId member, std::uint32_t topic) {
  return static_cast<std::uint32_t>(member) * 10 + topic;
}

/** @brief Let all members join, and answer each grant, until nobody gets one. */
template <typename Members>
void runToItsEnd(Members& members) {
  for (ConnectionId member = 1; member <= kMembers; ++member) {
    members.join(member, std::string("/") + static_cast<char>('a' + member - 1));
  }
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (ConnectionId member = 1; member <= kMembers; ++member) {
      if (const auto next = members.grant(member)) {
        members.answer(member, *next);
        goes_on = true;
      }
    }
  }
}

/** @brief Members that send at instants of a program, whatever they hear. */
struct Program : Stage {
  Program(std::uint32_t program, const LockstepSettings& settings) : Stage(settings), key(program) {
    runToItsEnd(*this);
  }

  void answer(ConnectionId member, const ClientGrant& got) {
    for (const wire::GrantItem& item : got.grant.items) {
      heard[member].push_back(itemText(item));
      at[member].push_back(got.grant.time_ns);
    }
    const int step = static_cast<int>((got.grant.time_ns - kSecond) / kStep);
    Items items;
    Texts texts;
    if (done[member].empty()) {
      items = links(member, &texts);
    }
    const bool is_due = (got.grant.time_ns - kSecond) % kStep == 0;
    if (is_due && done[member].insert(step).second && step > 0) {
      items = sends(member, step);
    }
    const Nanoseconds next = kSecond + (*done[member].rbegin() + 1) * kStep;
    report(member, *done[member].rbegin() < kSteps ? next : kNever, items);
    payloads.clear();
  }

  Items links(ConnectionId member, Texts* texts) {
    Items items;
    texts->reserve(2 * kMembers * kTopics);
    for (ConnectionId other = 1; other <= kMembers; ++other) {
      for (std::uint32_t topic = 0; topic < kTopics; ++topic) {
        texts->push_back("/t" + std::to_string(topicNumber(other, topic)));
        items.push_back(subscribe(topicNumber(other, topic), texts->back()));
        if (other == member) {
          items.push_back(advertise(topicNumber(other, topic), texts->back()));
        }
      }
    }
    return items;
  }

  Items sends(ConnectionId member, int step) {
    Items items;
    payloads.reserve(8);
    const auto count = chaos::mixed({key, member, static_cast<std::uint64_t>(step)}) % 6;
    for (std::uint64_t k = 0; k < count; ++k) {
      const auto topic = static_cast<std::uint32_t>(
          chaos::mixed({key, member, static_cast<std::uint64_t>(step), k}) % kTopics);
      payloads.push_back(std::to_string(member) + "." + std::to_string(step) + "." +
                         std::to_string(k));
      items.push_back(wire::Send{topicNumber(member, topic), 0, 0, payloads.back()});
    }
    return items;
  }

  const std::uint64_t key;
  Texts payloads;
  std::map<ConnectionId, std::set<int>> done;
  std::map<ConnectionId, Texts> heard;
  std::map<ConnectionId, std::vector<Nanoseconds>> at;
};

/** @return what came over each connection of @p heard, in its order: "deliver 12 1", "publisher".
 */
std::map<std::string, Texts> byLink(const Texts& heard) {
  std::map<std::string, Texts> links;
  for (const std::string& item : heard) {
    const auto end = item.rfind(' ');
    if (item.rfind("deliver", 0) == 0) {
      links[item.substr(8, end - 8)].push_back(item.substr(end + 1));
    } else if (item.rfind("publisher", 0) == 0) {
      links[item.substr(10)].push_back("open");
    }
  }
  return links;
}

TEST(Chaos, KeepsEachConnectionsOrderAndLosesNothing) {
  std::set<Texts> orders;
  for (std::uint32_t program = 1; program <= 8; ++program) {
    Program stated(program, chaotic(0));
    for (std::uint32_t seed = 1; seed <= 12; ++seed) {
      for (const double delay : {0.0, 0.25}) {
        Program other(program, chaotic(seed, delay));
        for (ConnectionId member = 1; member <= kMembers; ++member) {
          ASSERT_EQ(byLink(other.heard[member]), byLink(stated.heard[member]))
              << "program " << program << " seed " << seed;
          orders.insert(other.heard[member]);
        }
      }
    }
  }
  EXPECT_GT(orders.size(), 500U);
}

TEST(Chaos, ADelayIsAtMostTheBound) {
  Program stated(1, chaotic(0));
  bool any = false;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    Program other(1, chaotic(seed, 0.25));
    for (ConnectionId member = 1; member <= kMembers; ++member) {
      std::map<std::string, Nanoseconds> sent;
      for (std::size_t k = 0; k < stated.heard[member].size(); ++k) {
        sent[stated.heard[member][k]] = stated.at[member][k];
      }
      for (std::size_t k = 0; k < other.heard[member].size(); ++k) {
        const Nanoseconds late = other.at[member][k] - sent.at(other.heard[member][k]);
        ASSERT_GE(late, 0);
        ASSERT_LE(late, kSecond / 4);
        any = any || late > 0;
      }
    }
  }
  EXPECT_TRUE(any);
}

TEST(Chaos, ASeedIsOneRun) {
  Program first(3, chaotic(7, 0.1));
  Program second(3, chaotic(7, 0.1));
  EXPECT_EQ(first.heard, second.heard);
  EXPECT_EQ(lines(first.session), lines(second.session));
  EXPECT_FALSE(first.session.takeDecisions().empty());
}

TEST(Chaos, WithoutADecisionItIsTheStatedOrder) {
  Program stated(3, chaotic(0));
  Program none(3, chaotic(7, 0.1, "none"));
  EXPECT_EQ(stated.heard, none.heard);
  EXPECT_EQ(lines(stated.session), lines(none.session));
  EXPECT_TRUE(none.session.takeDecisions().empty());
}

TEST(Chaos, OneDecisionAloneIsApplied) {
  Program all(3, chaotic(7, 0.1));
  std::size_t same = 0;
  const auto decisions = all.session.takeDecisions();
  ASSERT_GT(decisions.size(), 3U);
  for (const chaos::Decision& decision : decisions) {
    Program one(3, chaotic(7, 0.1, decision.name));
    const auto applied = one.session.takeDecisions();
    same += applied.size() == 1 && applied[0].says == decision.says ? 1 : 0;
  }
  EXPECT_GT(same, decisions.size() / 2);  // of others the draw is another thing to go ahead of
}

TEST(Chaos, TellsWhatHappened) {
  Program all(3, chaotic(7, 0.1));
  std::set<std::string> kinds;
  for (const chaos::Decision& decision : all.session.takeDecisions()) {
    kinds.insert(decision.what);
    EXPECT_NE(decision.says.find(decision.what == "order"   ? " before "
                                 : decision.what == "delay" ? " was under way to "
                                                            : " took effect before "),
              std::string::npos);
  }
  EXPECT_GE(kinds.size(), 2U);
  EXPECT_EQ(all.session.status().chaos, "chaos seed 7 with delays up to 0.1 s");
}

TEST(Chaos, TellsWhatCameBehindAnEarlierOneOfItsConnection) {
  chaos::Decisions decisions(7, std::nullopt, true);
  chaos::Delays delays(decisions, kSecond);
  Nanoseconds before = 0;
  std::map<bool, int> counts;  // of those that waited and of others
  for (Nanoseconds sent = 0; sent < kSecond; sent += kSecond / 1000) {
    Passage passage{Passage::Kind::kMessage, 1, 2,    "/a", "/b", "/topic",
                    "std_msgs/Empty",        0, false};
    passage.from = sent;
    const Nanoseconds arrives = delays.carry(passage).due;
    for (const chaos::Decision& decision : decisions.take()) {
      const bool waited =
          decision.says.find(", and came behind an earlier one, after ") != std::string::npos;
      EXPECT_EQ(waited, arrives == before) << decision.says;
      ++counts[waited];
    }
    EXPECT_GE(arrives, before);
    before = arrives;
  }
  EXPECT_GT(counts[true], 0);
  EXPECT_GT(counts[false], 0);
}

/** @brief /a and /b call what /c serves, three times in each turn; /c answers all at once. */
struct Calls : Stage {
  explicit Calls(const LockstepSettings& settings) : Stage(settings) { runToItsEnd(*this); }

  void answer(ConnectionId member, const ClientGrant& next) {
    const wire::Grant& got = next.grant;
    Items items;
    for (const wire::GrantItem& item : got.items) {
      if (const auto* call = std::get_if<wire::CallIn>(&item)) {
        calls[call->caller].push_back(call->number);
        items.push_back(wire::Response{call->caller, call->number, true, "done"});
      } else if (const auto* done = std::get_if<wire::Answer>(&item)) {
        answers[ids[member]].push_back(done->number);
      }
    }
    const bool calls_now = member <= 2 && numbers[member] < 30 && got.time_ns >= kSecond + kStep;
    for (int k = 0; calls_now && k < 3; ++k) {
      items.push_back(wire::Call{numbers[member]++, 0, "/s", "please"});
    }
    if (member == 3 && !serves) {
      serves = true;
      items.push_back(wire::Serve{1, 0, "/s"});
    }
    report(member, member <= 2 && numbers[member] < 30 ? got.time_ns + kStep : kNever, items);
  }

  bool serves = false;
  std::map<ConnectionId, std::uint32_t> numbers;
  std::map<MemberId, std::vector<std::uint32_t>> calls;
  std::map<MemberId, std::vector<std::uint32_t>> answers;
};

TEST(Chaos, EachCallIsHeardInItsOrderAndAnsweredOnce) {
  std::set<std::vector<std::uint32_t>> orders;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    for (const double delay : {0.0, 0.25}) {
      Calls run(chaotic(seed, delay));
      for (const MemberId client : {run.ids[1], run.ids[2]}) {
        std::vector<std::uint32_t> heard = run.calls[client];
        std::vector<std::uint32_t> answered = run.answers[client];
        ASSERT_GE(heard.size(), 30U);
        EXPECT_TRUE(std::is_sorted(heard.begin(), heard.end()));
        EXPECT_EQ(std::set<std::uint32_t>(heard.begin(), heard.end()).size(), heard.size());
        orders.insert(answered);
        std::sort(answered.begin(), answered.end());
        EXPECT_EQ(answered, heard);
      }
    }
  }
  EXPECT_GT(orders.size(), 5U);
}

TEST(Chaos, RefusesWhatCannotBe) {
  EXPECT_NE(refusal([] { chaos::decisionsOf("0123456789ab,x"); }).find("got 'x'"),
            std::string::npos);
  LockstepSettings settings = chaotic(1);
  settings.lookahead = 0.1;
  EXPECT_NE(refusal([&] { LockstepSession session(settings, 0); }).find("chaos_seed must be 0"),
            std::string::npos);
  EXPECT_NE(
      refusal([] { LockstepSession session(chaotic(0, 0.1), 0); }).find("without a chaos_seed"),
      std::string::npos);
}

TEST(Chaos, ItsRuleCanBeBroken) {
  const auto is_legal = [] {
    for (std::uint32_t seed = 1; seed <= 12; ++seed) {
      Program stated(1, chaotic(0));
      Program other(1, chaotic(seed));
      for (ConnectionId member = 1; member <= kMembers; ++member) {
        if (byLink(other.heard[member]) != byLink(stated.heard[member])) {
          return false;
        }
      }
    }
    return true;
  };
  EXPECT_TRUE(is_legal());
  const Broken broken("chaos_within_connection");
  EXPECT_FALSE(is_legal());
}

TEST(Chaos, DrawsAreTheSameEverywhere) {
  EXPECT_EQ(chaos::mixed(0), 0xE220A8397B1DCDAFU);  // SplitMix64's first of the state 0
  EXPECT_EQ(chaos::hashOf("a"), 0xAF63DC4C8601EC8CU);
}

}  // namespace
}  // namespace move_base_abstract::lockstep_chaos_test
