// Turns that a report tells beforehand: they come as if they had been granted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "lockstep_client.h"
#include "lockstep_items.h"

namespace move_base_abstract::lockstep_foreseen_test {
namespace {

using Texts = std::vector<std::string>;
using Items = std::vector<wire::ReportItem>;

constexpr std::uint32_t kNews = 1;
constexpr std::uint32_t kAnswers = 2;

Texts grants(Stage& stage, ConnectionId id) {
  return grants(stage, id, [](const wire::GrantItem& item) { return itemText(item); });
}

/** @brief /a tells news, to which /b listens; /b gives answers, to which /a listens. All linked. */
struct Linked : Pair {
  Linked() {
    report(1, kNever, {advertise(kNews, "/news"), subscribe(kAnswers, "/answers")});
    report(2, kNever, {subscribe(kNews, "/news"), advertise(kAnswers, "/answers")});
    grants(*this, 1);
    grants(*this, 2);
  }
};

wire::At at(Nanoseconds seconds) { return {seconds * kSecond}; }
wire::Send news(std::string_view payload) { return {kNews, 0, 0, payload}; }
wire::Send answer(std::string_view payload) { return {kAnswers, 0, 0, payload}; }

// ---- by hand ---------------------------------------------------------------------------------

TEST(Foreseen, TurnsComeAtTheirInstantsWithoutAGrant) {
  Linked stage;
  stage.report(1, 9 * kSecond, {at(3), news("x"), news("y"), at(4), at(5), news("z")});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"3000+1: deliver 1 1 x deliver 1 1 y"});
  stage.report(2, kNever);  // at 4 s nothing is heard
  EXPECT_EQ(grants(stage, 2), Texts{"5000+1: deliver 1 1 z"});
  EXPECT_EQ(grants(stage, 1), Texts{});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 1), Texts{"9000+0: happened 3"});
  EXPECT_EQ(stage.session.status().leaps, 4U);
}

TEST(Foreseen, AGrantTakesBackWhatIsStillToCome) {
  Linked stage;
  stage.report(1, 9 * kSecond, {at(3), news("x"), at(6), news("never")});
  stage.report(2, kNever);
  grants(stage, 2);
  stage.report(2, kNever, {answer("stop")});
  EXPECT_EQ(grants(stage, 1), Texts{"3000+2: happened 1 deliver 2 2 stop"});
  stage.report(1, 7 * kSecond);
  EXPECT_EQ(grants(stage, 1), Texts{"7000+0:"});
  EXPECT_EQ(grants(stage, 2), Texts{});
}

TEST(Foreseen, AGrantInTheFirstMomentTakesBackAll) {
  Linked stage;
  stage.report(1, 9 * kSecond, {at(3), news("never")});
  stage.report(2, kNever, {answer("stop")});
  EXPECT_EQ(grants(stage, 1), Texts{"1000+2: happened 0 deliver 2 2 stop"});
}

TEST(Foreseen, WhatIsDueAtTheSameInstantIsInTheSameRound) {
  Linked stage;
  stage.report(1, 9 * kSecond, {at(3), news("x")});
  stage.report(2, 3 * kSecond);
  EXPECT_EQ(grants(stage, 2), Texts{"3000+0:"});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"3000+1: deliver 1 1 x"});
}

TEST(Foreseen, TimeMayStandAtTheInstantOfATurnThatThenIsTakenBack) {
  Linked stage;
  stage.session.runUntil(3 * kSecond);
  stage.report(1, 9 * kSecond, {at(2), news("x"), at(3), news("y"), at(4), news("never")});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"2000+1: deliver 1 1 x"});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"3000+1: deliver 1 1 y"});
  stage.report(2, kNever);
  stage.frame(1, wire::Knock{});
  EXPECT_EQ(grants(stage, 1), Texts{"3000+2: happened 2"});
}

TEST(Foreseen, WhoHasGoneTellsNothingMore) {
  Linked stage;
  stage.report(1, 9 * kSecond, {at(3), news("never")});
  stage.cut(1);
  stage.report(2, 5 * kSecond);
  EXPECT_EQ(grants(stage, 2), Texts{"1000+2: no publisher 1 1 no subscriber 2 1"});
}

TEST(Foreseen, WhatIsWrongEndsItsOwnConnectionAndSaysWhy) {
  struct Case {
    Items items;
    Nanoseconds next;
    bool leaving;
    const char* end;
  };
  const std::vector<Case> cases{
      {{at(1)},
       9 * kSecond,
       false,
       "AT must be after 1 s and before the wake-up of its report, 9 s"},
      {{at(4), at(4)}, 9 * kSecond, false, "AT must be after 4 s"},
      {{at(9)}, 9 * kSecond, false, "before the wake-up of its report, 9 s, got 9 s"},
      {{at(3), subscribe(7, "/x")}, 9 * kSecond, false, "after AT there must be SEND and AT only"},
      {{at(3), news("x")}, kNever, true, "AT must not be in a last report"}};
  for (const Case& one : cases) {
    Linked stage;
    stage.frame(1, wire::Report{2, one.leaving, one.next, 0, one.items});
    EXPECT_TRUE(stage.closed[1]) << one.end;
    EXPECT_NE(stage.end[1].find(one.end), std::string::npos) << stage.end[1];
    EXPECT_FALSE(stage.closed[2]);
  }
}

// ---- by chance -------------------------------------------------------------------------------

/** @brief The same numbers for the same seed, on every machine. */
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : state_(seed * 2654435761U + 1) {}
  std::uint64_t below(std::uint64_t limit) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return (state_ >> 33U) % limit;
  }
  void stir(std::uint64_t value) { state_ = (state_ ^ value) * 1099511628211U; }

 private:
  std::uint64_t state_;
};

/** @brief Tells news at instants that follow from what it has heard; live, or beforehand. */
class Teller {
 public:
  Teller(std::uint64_t seed, std::size_t foresees) : chance_(seed), foresees_(foresees) {}

  void answer(Stage& stage, const wire::Grant& grant) {
    std::vector<std::string> said;
    for (const wire::GrantItem& item : grant.items) {
      if (const auto* happened = std::get_if<wire::Happened>(&item)) {
        plan_.erase(plan_.begin(), plan_.begin() + happened->count);
      } else if (std::holds_alternative<wire::Deliver>(item)) {
        said.push_back("re " + std::string(std::get<wire::Deliver>(item).payload));
        chance_.stir(static_cast<std::uint64_t>(grant.time_ns) + said.size());
        planAnew(grant.time_ns);
      }
    }
    while (!plan_.empty() && plan_.front().first <= grant.time_ns) {
      said.push_back(plan_.front().second);
      plan_.pop_front();
    }
    if (plan_.empty() && ++plans_ < 20) {
      planAnew(grant.time_ns);
    }
    Items items;
    for (const std::string& what : said) {
      items.emplace_back(news(what));
    }
    // The last turn of a plan makes the next plan: that one does more than tell.
    const std::size_t told = plan_.empty() ? 0 : std::min(foresees_, plan_.size() - 1);
    for (std::size_t k = 0; k < told; ++k) {
      items.emplace_back(wire::At{plan_[k].first});
      items.emplace_back(news(plan_[k].second));
    }
    stage.report(1, told < plan_.size() ? plan_[told].first : kNever, items);
  }

 private:
  void planAnew(Nanoseconds now) {
    plan_.clear();
    for (std::uint64_t left = 1 + chance_.below(6); left > 0; --left) {
      now += 1'000'000 * static_cast<Nanoseconds>(1 + chance_.below(5));
      plan_.emplace_back(now, "news of " + std::to_string(now));
    }
  }

  Chance chance_;
  std::size_t foresees_;
  std::deque<std::pair<Nanoseconds, std::string>> plan_;
  int plans_ = 0;
};

/** A participant that hears, and answers now and then; what it does follows from what it was
 * granted. */
class Listener {
 public:
  Listener(ConnectionId id, std::uint64_t seed) : id_(id), chance_(seed) {}

  /** Reports, if there is a grant. @return whether there was one. */
  bool turn(Stage& stage) {
    const auto granted = stage.grant(id_);
    if (!granted) {
      return false;
    }
    std::string line = std::to_string(id_) + " " + std::to_string(granted->grant.time_ns) + "+" +
                       std::to_string(granted->grant.microstep);
    for (const wire::GrantItem& item : granted->grant.items) {
      line += " " + itemText(item);
    }
    seen.push_back(line);
    const bool speaks = chance_.below(4) == 0 && seen.size() < 80;
    const Nanoseconds later =
        granted->grant.time_ns + 500'000 * static_cast<Nanoseconds>(1 + chance_.below(9));
    const Nanoseconds wake = chance_.below(2) == 0 ? kNever : later;
    stage.report(id_, wake, speaks ? Items{answer(line.substr(0, 20))} : Items{});
    return true;
  }

  Texts seen;

 private:
  ConnectionId id_;
  Chance chance_;
};

/** Joins a teller, 1, and two listeners, 2 and 3, and connects them. */
void begin(Stage& stage) {
  for (const ConnectionId id : {1U, 2U, 3U}) {
    stage.join(id, std::string("/") + "?abc"[id], id == 2 ? 5 : 0);
  }
  for (const ConnectionId id : {1U, 2U, 3U}) {
    stage.grant(id);
  }
  stage.report(1, 2 * kSecond, {advertise(kNews, "/news"), subscribe(kAnswers, "/answers")});
  for (const ConnectionId id : {2U, 3U}) {
    stage.report(id, 2 * kSecond + id,
                 {subscribe(kNews, "/news"), advertise(kAnswers, "/answers")});
  }
}

/** @return what two listeners were granted, each, who answer now and then. */
std::vector<Texts> play(std::uint64_t seed, std::size_t foresees) {
  Stage stage(named({"/a", "/b", "/c"}));
  begin(stage);
  Teller teller(seed, foresees);
  std::vector<Listener> listeners{{2, seed + 1}, {3, seed + 2}};
  bool moves = true;
  for (int rounds = 0; moves && rounds < 5000; ++rounds) {
    moves = false;
    if (const auto granted = stage.grant(1)) {
      teller.answer(stage, granted->grant);
      moves = true;
    }
    for (Listener& listener : listeners) {
      moves = listener.turn(stage) || moves;
    }
  }
  EXPECT_TRUE(stage.end.empty()) << stage.end.begin()->second;
  return {listeners[0].seen, listeners[1].seen};
}

TEST(Foreseen, RandomRunsAreTheSameHoweverMuchIsForeseen) {
  std::size_t seen = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const std::vector<Texts> live = play(seed, 0);
    seen += live[0].size() + live[1].size();
    for (const std::size_t foresees : {1U, 2U, 9U}) {
      EXPECT_TRUE(play(seed, foresees) == live) << "seed " << seed << ", " << foresees << " turns";
    }
  }
  EXPECT_GT(seen, 3000U);
}

}  // namespace
}  // namespace move_base_abstract::lockstep_foreseen_test
