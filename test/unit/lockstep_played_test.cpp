// Messages that the time master makes: they come as if the participant had been granted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "lockstep_news.h"

namespace move_base_abstract::lockstep_played_test {
namespace {

using namespace lockstep_news;

/** @brief News at @p first, and then once in @p period [s]; without one only once. */
wire::Play plays(Nanoseconds first, std::string_view payload, Nanoseconds period = 0,
                 std::string_view slots = {}) {
  return {kNews,   0,    0, false, 7, first * kSecond, period == 0 ? kNever : period * kSecond,
          payload, slots};
}
wire::Send news(std::string_view payload) { return {kNews, 0, 0, payload}; }
wire::Send answer(std::string_view payload) { return {kAnswers, 0, 0, payload}; }

// ---- by hand ---------------------------------------------------------------------------------

TEST(Played, MessagesComeAtTheirInstantsWithoutAGrant) {
  Linked stage;
  stage.report(1, 9 * kSecond, {plays(3, "x", 2), plays(5, "y"), plays(9, "never")});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"3000+1: deliver 1 1 x"});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"5000+1: deliver 1 1 x deliver 1 1 y"});
  EXPECT_EQ(grants(stage, 1), Texts{});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"7000+1: deliver 1 1 x"});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 1), Texts{"9000+0: happened 7000"});
}

TEST(Played, AGrantEndsThem) {
  Linked stage;
  stage.report(1, 9 * kSecond, {plays(3, "x", 3)});
  stage.report(2, kNever);
  grants(stage, 2);
  stage.report(2, kNever, {answer("stop")});
  EXPECT_EQ(grants(stage, 1), Texts{"3000+2: happened 3000 deliver 2 2 stop"});
  stage.report(1, 7 * kSecond);
  EXPECT_EQ(grants(stage, 1), Texts{"7000+0:"});
  EXPECT_EQ(grants(stage, 2), Texts{});
}

TEST(Played, WhatIsDueAtTheSameInstantIsInTheSameRound) {
  Linked stage;
  stage.report(1, 9 * kSecond, {plays(3, "x")});
  stage.report(2, 3 * kSecond);
  EXPECT_EQ(grants(stage, 2), Texts{"3000+0:"});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"3000+1: deliver 1 1 x"});
}

TEST(Played, TimeMayStandAtTheInstantOfTheLatestMessage) {
  Linked stage;
  stage.session.runUntil(3 * kSecond);
  stage.report(1, 9 * kSecond, {plays(2, "x", 1)});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"2000+1: deliver 1 1 x"});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"3000+1: deliver 1 1 x"});
  stage.report(2, kNever);
  stage.frame(1, wire::Knock{});
  EXPECT_EQ(grants(stage, 1), Texts{"3000+2: happened 3000"});
}

TEST(Played, WhoHasGoneSendsNothingMore) {
  Linked stage;
  stage.report(1, 9 * kSecond, {plays(3, "never")});
  stage.cut(1);
  stage.report(2, 5 * kSecond);
  EXPECT_EQ(grants(stage, 2), Texts{"1000+2: no publisher 1 1 no subscriber 2 1"});
}

TEST(Played, OfTheSameTopicAndRobotOnlyOneComesAtAnInstantIfTheySaySo) {
  Linked stage;
  wire::Play first = plays(3, "x", 2);
  wire::Play second = plays(3, "y", 1);
  wire::Play other = plays(3, "z", 1);
  first.once = second.once = other.once = true;
  other.sub = 1;
  stage.report(1, 9 * kSecond, {first, second, other});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"3000+1: deliver 1 1 x deliver 1 1 z"});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"4000+1: deliver 1 1 y deliver 1 1 z"});
}

LockstepSettings withLookahead() {
  LockstepSettings settings = named({"/a", "/b"});
  settings.lookahead = 1.0;
  return settings;
}

TEST(Played, WithALookaheadNobodyIsGrantedForMessages) {
  Pair stage(withLookahead());
  stage.report(1, kNever, {advertise(kNews, "/news")});
  stage.report(2, kNever, {subscribe(kNews, "/news")});
  EXPECT_EQ(grants(stage, 1), Texts{"2000+0: to 3000000000 subscriber 1 2"});
  grants(stage, 2);
  stage.report(1, 9 * kSecond, {plays(3, "x", 4)});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"4000+0: to 5000000000 deliver 1 1 x"});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 1), Texts{});
  EXPECT_EQ(grants(stage, 2), Texts{"8000+0: to 9000000000 deliver 1 1 x"});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 1), Texts{"9000+0: to 10000000000 happened 8999"});
}

TEST(Played, AMessageComesBeforeTheOwnTurnOfItsWindow) {
  Linked stage(nullptr, withLookahead());
  const wire::At half{2 * kSecond + kSecond / 2};
  wire::Play before = plays(2, "x");
  before.first_ns += kSecond / 4;
  before.period_ns = kSecond / 2;  // the next one would come after the turn at 2.5 s, which ends it
  stage.report(1, 3 * kSecond + kSecond / 2, {before, half, news("y"), plays(3, "z")});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 1), Texts{"3500+0: to 4000000000 happened 3499"});
  stage.report(1, kNever);
  EXPECT_EQ(grants(stage, 2),
            Texts{"3250+0: to 4000000000 deliver 1 1 x at 3500000000 deliver 1 1 y"});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"4000+0: to 5000000000 deliver 1 1 z"});
}

TEST(Played, AKnockInAWindowComesAfterWhatHasBeenPlayedInIt) {
  Linked stage(nullptr, withLookahead());
  stage.report(1, 9 * kSecond, {plays(3, "x", 1)});
  stage.report(2, 3 * kSecond);
  EXPECT_EQ(grants(stage, 2), Texts{"3000+0: to 4000000000"});
  stage.frame(1, wire::Knock{});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 1), Texts{"3000+1: to 4000000000 happened 3000"});
}

// ---- slots -----------------------------------------------------------------------------------

template <typename Number>
std::string bytesOf(Number value) {
  char bytes[sizeof(value)];
  std::memcpy(bytes, &value, sizeof(value));
  return std::string(bytes, sizeof(value));
}

std::string slot(wire::Slot kind, std::uint32_t place) {
  return bytesOf(static_cast<std::uint8_t>(kind)) + bytesOf(place);
}

/** @return a motion from 2 s on: eastwards at 1 m/s, and turning by 1 rad/s. */
std::string pieces() {
  std::string bytes = bytesOf(std::int64_t{2'000'000'000});
  for (const double number : {1.0, 2.0, 0.5, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0}) {
    bytes += bytesOf(number);
  }
  return bytes;
}

/** @return the payload of the first message of @p id's next grant. */
std::string heard(Stage& stage, ConnectionId id) {
  const auto next = stage.grant(id);
  return next ? std::string(std::get<wire::Deliver>(next->grant.items.at(0)).payload) : "none";
}

TEST(Played, NumbersAndStampsAreWrittenIntoTheMessages) {
  Linked stage;
  const std::string slots = slot(wire::Slot::kNumber, 1) + slot(wire::Slot::kStamp, 6);
  wire::Play one = plays(3, "<....|........>", 2, slots);
  one.period_ns += 5;
  stage.report(1, 9 * kSecond, {one});
  stage.report(2, kNever);
  EXPECT_EQ(heard(stage, 2), "<" + bytesOf(7) + "|" + bytesOf(3) + bytesOf(0) + ">");
  stage.report(2, kNever);
  EXPECT_EQ(heard(stage, 2), "<" + bytesOf(8) + "|" + bytesOf(5) + bytesOf(5) + ">");
}

TEST(Played, PosesAndVelocitiesFollowFromTheMotionOfTheRobotOrOfItsOdometry) {
  for (const std::uint32_t sub : {0U, wire::kOdometry}) {
    Linked stage;
    const std::string motion = pieces(), payload(56 + 48, '.'), dots(24, '.');
    const std::string slots = slot(sub == 0 ? wire::Slot::kPose : wire::Slot::kOdomPose, 0) +
                              slot(sub == 0 ? wire::Slot::kTwist : wire::Slot::kOdomTwist, 56);
    stage.report(1, 9 * kSecond, {wire::Motion{sub, "r", motion}, plays(3, payload, 1, slots)});
    stage.report(2, kNever);
    for (const double elapsed : {1.0, 2.0}) {
      const double half = (0.5 + elapsed) / 2.0;
      EXPECT_EQ(heard(stage, 2), bytesOf(1.0 + elapsed) + bytesOf(2.0) + dots +
                                     bytesOf(std::sin(half)) + bytesOf(std::cos(half)) +
                                     bytesOf(1.0) + bytesOf(0.0) + dots + bytesOf(1.0));
      stage.report(2, kNever);
    }
  }
}

TEST(Played, WhatIsWrongEndsItsOwnConnectionAndSaysWhy) {
  struct Case {
    Items items;
    const char* end;
  };
  const std::string beyond = slot(wire::Slot::kStamp, 1);
  const std::string unknown = slot(static_cast<wire::Slot>(9), 0);
  const std::string pose = slot(wire::Slot::kPose, 0);
  const std::string payload(56, '.');
  wire::Play again = plays(3, "x");
  again.period_ns = 0;
  const std::vector<Case> cases{
      {{plays(1, "x")}, "PLAY must begin after 1 s"},
      {{again}, "with a period above 0 s, got 3 s and 0 s"},
      {{plays(3, "12345678", 1, beyond)}, "within the 8 bytes of the payload, got kind 1 at 1"},
      {{plays(3, "x", 1, unknown)}, "must be of a known kind"},
      {{plays(3, "x", 1, "1234")}, "must have 5 bytes each, got 4"},
      {{plays(3, payload, 1, pose)}, "a robot whose MOTION was told, got 0"},
      {{wire::Motion{0, "robot_0", "short"}}, "a motion must have pieces of 80 bytes, got 5 bytes"},
      {{wire::At{3 * kSecond}}, "AT must be in a window"}};
  for (const Case& one : cases) {
    Linked stage;
    stage.frame(1, wire::Report{2, false, 9 * kSecond, 0, one.items});
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

/** @brief Tells news at instants that follow from what it has heard; live, or played. */
class Teller {
 public:
  Teller(std::uint64_t seed, std::size_t most) : chance_(seed), most_(most) {}

  void answer(Stage& stage, const wire::Grant& grant) {
    std::vector<std::string> said;
    for (const wire::GrantItem& item : grant.items) {
      if (const auto* happened = std::get_if<wire::Happened>(&item)) {
        while (!plan_.empty() && plan_.front().first <= happened->until_ns) {
          plan_.pop_front();
        }
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
    const std::size_t told = plan_.empty() ? 0 : std::min(most_, plan_.size() - 1);
    for (std::size_t k = 0; k < told; ++k) {
      items.emplace_back(
          wire::Play{kNews, 0, 0, false, 0, plan_[k].first, kNever, plan_[k].second, {}});
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
  std::size_t most_;  // messages that are played
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
std::vector<Texts> play(std::uint64_t seed, std::size_t most) {
  Stage stage(named({"/a", "/b", "/c"}));
  begin(stage);
  Teller teller(seed, most);
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

TEST(Played, RandomRunsAreTheSameHoweverMuchIsPlayed) {
  std::size_t seen = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const std::vector<Texts> live = play(seed, 0);
    seen += live[0].size() + live[1].size();
    for (const std::size_t most : {1U, 2U, 9U}) {
      EXPECT_TRUE(play(seed, most) == live) << "seed " << seed << ", " << most << " messages";
    }
  }
  EXPECT_GT(seen, 3000U);
}

}  // namespace
}  // namespace move_base_abstract::lockstep_played_test
