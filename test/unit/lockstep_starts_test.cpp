// Nodes that start late, and links that are up late: what must stay, whatever the seed.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "broken.h"
#include "lockstep/chaos/decisions.h"
#include "lockstep/chaos/starts.h"
#include "lockstep_client.h"
#include "lockstep_items.h"

namespace move_base_abstract::lockstep_starts_test {
namespace {

using Items = std::vector<wire::ReportItem>;
using Texts = std::vector<std::string>;

constexpr double kMost = 0.5;  // s
constexpr Nanoseconds kBound = kSecond / 2;
constexpr Nanoseconds kStep = kSecond / 100;
constexpr Nanoseconds kEnd = 2 * kSecond;
constexpr std::uint32_t kTopic = 5;
constexpr std::uint32_t kSeeds = 60;

LockstepSettings late(std::uint32_t seed, const std::string& only = "", double most = kMost) {
  LockstepSettings settings = named({"/talker", "/ear", "/other_ear"});
  settings.log_messages = true;
  settings.chaos_seed = seed;
  settings.chaos_starts = seed == 0 ? 0.0 : most;
  settings.chaos_only = only;
  settings.keeps_decisions = true;
  return settings;
}

/** @brief /talker counts aloud every 10 ms, and two listen. */
struct Counting : Stage {
  explicit Counting(const LockstepSettings& settings) : Stage(settings) {
    for (ConnectionId member = 1; member <= settings.participants.size(); ++member) {
      join(member, settings.participants[member - 1]);
    }
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      for (ConnectionId member = 1; member <= settings.participants.size(); ++member) {
        if (const auto next = grant(member)) {
          answer(member, next->grant);
          goes_on = true;
        }
      }
    }
  }

  void answer(ConnectionId member, const wire::Grant& got) {
    Items items;
    const std::string text = std::to_string(got.time_ns);
    if (first.emplace(member, got.time_ns).second) {
      items.push_back(member == 1 ? wire::ReportItem(advertise(kTopic, "/numbers"))
                                  : wire::ReportItem(subscribe(kTopic, "/numbers")));
      due[member] = got.time_ns;
    }
    for (const wire::GrantItem& item : got.items) {
      if (const auto* one = std::get_if<wire::Deliver>(&item)) {
        heard[member].push_back(std::stoll(std::string(one->payload)));
      } else {
        news[member].emplace_back(got.time_ns, itemText(item));
      }
    }
    if (member == 1 && got.time_ns >= due[1]) {
      said.push_back(got.time_ns);
      items.push_back(wire::Send{kTopic, 0, 0, text});
      due[1] = got.time_ns + kStep;
    }
    report(member, member == 1 && due[1] < kEnd ? due[1] : kNever, items);
  }

  std::map<ConnectionId, Nanoseconds> first;  // grants
  std::map<ConnectionId, Nanoseconds> due;
  std::vector<Nanoseconds> said;
  std::map<ConnectionId, std::vector<Nanoseconds>> heard;
  std::map<ConnectionId, std::vector<std::pair<Nanoseconds, std::string>>> news;
};

TEST(Starts, EachNodeBeginsWithinTheBoundAndSomeAreLate) {
  int count = 0;
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    Counting run(late(seed));
    std::set<std::string> said;
    for (const chaos::Decision& decision : run.session.takeDecisions()) {
      if (decision.what == "start") {
        EXPECT_EQ(decision.time, kSecond);
        said.insert(decision.says.substr(0, decision.says.find(' ')));
      }
    }
    const std::vector<std::string> names = late(seed).participants;
    for (ConnectionId member = 1; member <= names.size(); ++member) {
      ASSERT_GE(run.first.at(member), kSecond);
      ASSERT_LE(run.first.at(member), kSecond + kBound);
      EXPECT_EQ(run.first.at(member) > kSecond, said.count(names[member - 1]) == 1) << seed;
    }
    count += static_cast<int>(said.size());
  }
  EXPECT_GT(count, 60);
  EXPECT_LT(count, 120);
}

/** @return whether listeners hear everything that is said once both ends know of their link. */
bool nothingIsLostOnceTheLinkIsUp(const Counting& run, Nanoseconds* latest) {
  for (const ConnectionId ear : {2U, 3U}) {
    const auto& of_talker = run.news.at(1);
    const auto told = std::find_if(of_talker.begin(), of_talker.end(), [&](const auto& one) {
      return one.second == "subscriber 5 " + std::to_string(ear);
    });
    const auto& of_ear = run.news.at(ear);
    if (told == of_talker.end() || of_ear.size() != 1 || of_ear[0].second != "publisher 5 1" ||
        of_ear[0].first != told->first) {
      return false;
    }
    const Nanoseconds up = told->first;
    const Nanoseconds both = std::max(run.first.at(1), run.first.at(ear));
    if (up < both || up > both + kBound / 10) {
      return false;
    }
    *latest = std::max(*latest, up - both);
    std::vector<Nanoseconds> expected;
    std::copy_if(run.said.begin(), run.said.end(), std::back_inserter(expected),
                 [up](Nanoseconds at) { return at > up; });
    std::vector<Nanoseconds> heard = run.heard.at(ear);
    heard.erase(std::remove(heard.begin(), heard.end(), up), heard.end());  // said as it comes up
    if (heard != expected) {
      return false;
    }
  }
  return true;
}

TEST(Starts, NothingIsLostOnceTheLinkIsUpAndNothingIsHeardBefore) {
  Nanoseconds latest = 0;
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    EXPECT_TRUE(nothingIsLostOnceTheLinkIsUp(Counting(late(seed)), &latest)) << seed;
  }
  EXPECT_GT(latest, 0);
}

TEST(Starts, ItsRuleCanBeBroken) {
  const Broken broken("chaos_late_link");
  Nanoseconds latest = 0;
  bool holds = true;
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    holds = holds && nothingIsLostOnceTheLinkIsUp(Counting(late(seed)), &latest);
  }
  EXPECT_FALSE(holds);
}

TEST(Starts, ASeedIsOneRunAndEachDecisionAppliesAlone) {
  std::size_t alone = 0;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    Counting first(late(seed));
    Counting second(late(seed));
    EXPECT_EQ(first.heard, second.heard);
    EXPECT_EQ(first.first, second.first);
    for (const chaos::Decision& decision : first.session.takeDecisions()) {
      Counting one(late(seed, decision.name));
      const auto applied = one.session.takeDecisions();
      ASSERT_EQ(applied.size(), 1U);
      EXPECT_EQ(applied[0].says, decision.says);
      ++alone;
    }
  }
  EXPECT_GT(alone, 10U);
}

TEST(Starts, WithoutADecisionAllStartTogether) {
  Counting stated(late(0));
  Counting none(late(4, "none"));
  EXPECT_EQ(stated.heard, none.heard);
  EXPECT_EQ(stated.first, none.first);
  EXPECT_EQ(stated.news, none.news);
  EXPECT_EQ(none.session.status().chaos,
            "chaos seed 4 with starts up to 0.5 s late, some decisions only");
  LockstepSettings all = late(4);
  all.chaos_delay = 0.05;
  EXPECT_EQ(LockstepSession(all, 0).status().chaos,
            "chaos seed 4 with delays up to 0.05 s and starts up to 0.5 s late");
}

TEST(Starts, ARunGoesOnAndEndsAlsoIfNobodyStartsAtOnce) {
  int late_ones = 0;
  int ended_before = 0;
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    LockstepSettings settings = late(seed);
    settings.participants = {"/talker"};
    Counting alone(settings);
    ASSERT_FALSE(alone.said.empty());
    late_ones += alone.first.at(1) > kSecond ? 1 : 0;
    settings.end_at = 1.2;
    Counting cut(settings);
    EXPECT_EQ(cut.phase(), "ended");
    ended_before += cut.first.empty() ? 1 : 0;
  }
  EXPECT_GT(late_ones, 0);
  EXPECT_GT(ended_before, 0);
}

TEST(Starts, TimeDoesNotStandForAServiceOfANodeThatStartsLate) {
  std::map<bool, std::set<std::size_t>> wanted;  // numbers of services, by whether one starts late
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    LockstepSettings settings = late(seed);
    settings.participants = {"/client", "/server"};
    Stage stage(settings);
    stage.session.holdForOthers("onlookers");
    stage.join(1, "/client");
    stage.join(2, "/server");
    const bool is_client = stage.grant(1).has_value();
    const bool is_server = stage.grant(2).has_value();
    if (is_client) {
      stage.report(1, kNever, {wire::Watch{"/s"}});
    }
    if (is_server) {
      stage.report(2, kNever);
    }
    if (is_client) {
      wanted[!is_server].insert(stage.session.wanted()->services.size());
    }
  }
  EXPECT_EQ(wanted[false], (std::set<std::size_t>{1}));
  EXPECT_EQ(wanted[true], (std::set<std::size_t>{0}));
}

TEST(Starts, RefusesWhatCannotBe) {
  EXPECT_NE(refusal([] {
              LockstepSettings settings = late(0);
              settings.chaos_starts = 0.1;
              LockstepSession session(settings, 0);
            }).find("without a chaos_seed"),
            std::string::npos);
}

}  // namespace
}  // namespace move_base_abstract::lockstep_starts_test
