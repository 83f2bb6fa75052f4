// When the event-driven clock moves: start, leaps, silence.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "clock/time_master.h"
#include "lockstep/rounds/rounds.h"
#include "lockstep_client.h"

namespace move_base_abstract::lockstep_rounds_test {
namespace {

// ---- names and settings ----------------------------------------------------------------------

TEST(NaturalOrder, CountsRunsOfDigitsAsNumbers) {
  const std::vector<std::string> sorted{"",        "/a",       "/a/b",      "/a1",    "/a01b",
                                        "/a2",     "/a02",     "/a10",      "/a10/x", "/a10b2",
                                        "/a10b10", "/robot_9", "/robot_10", "/z",     "/\xC3\xA9"};
  std::vector<std::string> names(sorted.rbegin(), sorted.rend());
  std::sort(names.begin(), names.end(), naturalLess);
  // "/a02" and "/a2" are one number: then the plain order decides.
  std::vector<std::string> expected = sorted;
  std::swap(expected[5], expected[6]);
  EXPECT_EQ(names, expected);
  EXPECT_TRUE(naturalLess("/r99999999999999999999998", "/r99999999999999999999999"));
  EXPECT_FALSE(naturalLess("/a", "/a"));
}

// ---- the end of an instant --------------------------------------------------------------------

LockstepSettings settledAtOnce() {
  LockstepSettings settings;
  settings.settle = 0.0;
  return settings;
}

struct PairAtRest : LockstepRounds {
  PairAtRest() : LockstepRounds(settledAtOnce()) {
    add(1, "/a", 1000, 0);
    add(2, "/b", 1000, 0);
    decide(kSecond);
  }
};

TEST(Rest, IsGrantedWhenNobodyHasAnythingLeftToDoAtTheInstant) {
  PairAtRest rounds;
  rounds.members().rest(1);
  rounds.report(1, kNever, 0, kSecond);
  rounds.report(2, rounds.now(), 0, kSecond);  // once more at this instant
  auto grants = rounds.decide(kSecond);
  ASSERT_EQ(grants.size(), 1U);
  EXPECT_EQ(grants[0].member, 2U);
  rounds.report(2, rounds.now() + 1, 0, kSecond);
  grants = rounds.decide(kSecond);
  ASSERT_EQ(grants.size(), 1U);
  EXPECT_EQ(grants[0].member, 1U);
  EXPECT_EQ(grants[0].time, kSecond);
  EXPECT_EQ(grants[0].microstep, 2U);
  rounds.report(1, kNever, 0, kSecond);  // once is enough
  grants = rounds.decide(kSecond);
  ASSERT_EQ(grants.size(), 1U);
  EXPECT_EQ(grants[0].time, kSecond + 1);
}

TEST(Background, AloneIsNoReasonForTimeToGoOn) {
  PairAtRest rounds;
  const Nanoseconds later = rounds.now() + 10;
  rounds.report(1, later, 0, kSecond);
  rounds.members().background(1);
  rounds.report(2, kNever, 0, kSecond);
  EXPECT_TRUE(rounds.decide(kSecond).empty());
  EXPECT_EQ(rounds.phase(kSecond), LockstepPhase::kIdle);
}

TEST(Background, HasItsInstantWhereTimeGoesOnForOthers) {
  PairAtRest rounds;
  const Nanoseconds begin = rounds.now();
  rounds.report(1, begin + 10, 0, kSecond);
  rounds.members().background(1);
  rounds.report(2, begin + 20, 0, kSecond);
  auto grants = rounds.decide(kSecond);
  ASSERT_EQ(grants.size(), 1U);
  EXPECT_EQ(grants[0].member, 1U);
  EXPECT_EQ(rounds.now(), begin + 10);
  rounds.report(1, begin + 30, 0, kSecond);  // what it said held for that report only
  grants = rounds.decide(kSecond);
  EXPECT_EQ(rounds.now(), begin + 20);
  rounds.report(2, kNever, 0, kSecond);
  EXPECT_EQ(rounds.decide(kSecond)[0].time, begin + 30);
}

TEST(Rest, OfAllComesAtOnceAndNotForThoseWhoHaveGone) {
  PairAtRest rounds;
  rounds.members().rest(2);
  rounds.members().rest(1);
  rounds.report(1, kNever, 0, kSecond);
  rounds.report(2, kNever, 0, kSecond);
  EXPECT_EQ(rounds.decide(kSecond).size(), 2U);
  rounds.members().rest(1);
  rounds.members().rest(2);
  rounds.report(1, kNever, 0, kSecond);
  rounds.members().gone(2);
  rounds.remove(2);
  EXPECT_EQ(rounds.decide(kSecond).size(), 1U);
}

TEST(Rest, EndsWithAnyOtherGrant) {
  PairAtRest rounds;
  rounds.members().rest(1);
  rounds.report(1, rounds.now(), 0, kSecond);
  rounds.report(2, kNever, 0, kSecond);
  EXPECT_EQ(rounds.decide(kSecond).size(), 1U);
  rounds.report(1, kNever, 0, kSecond);
  EXPECT_TRUE(rounds.decide(kSecond).empty());
}

// ---- start -----------------------------------------------------------------------------------

TEST(Start, WaitsForAllThatAreNamedAndNamesThoseThatAreMissing) {
  Stage stage(named({"/a", "/b"}));
  stage.join(1, "/a");
  EXPECT_EQ(stage.point(1), "none");
  EXPECT_EQ(stage.phase(), "waiting_for_participants");
  EXPECT_EQ(stage.session.now(), kSecond);
  ASSERT_EQ(stage.session.status().waiting_for.size(), 1U);
  EXPECT_EQ(stage.session.status().waiting_for[0].name, "/b");
  EXPECT_EQ(stage.session.status().waiting_for[0].owes, "its HELLO");
  for (int k = 1; k <= 3; ++k) {
    stage.messages.clear();
    ASSERT_EQ(stage.session.nextWake(), k * 5 * kSecond);
    stage.wall = k * 5 * kSecond - 1;
    stage.poll();
    EXPECT_FALSE(stage.said("does not start without"));
    stage.wall = k * 5 * kSecond;
    stage.poll();
    EXPECT_TRUE(stage.said("the clock does not start without '/b' (1 participant there)"));
  }
  stage.join(2, "/b");
  EXPECT_EQ(stage.point(1), "1000+0");
  EXPECT_EQ(stage.point(2), "1000+0");
  EXPECT_EQ(stage.session.status().not_repeatable, std::vector<std::string>{});
}

TEST(Start, OfUnnamedOnesComesWhenNobodyNewHasJoinedForAWhile) {
  Stage stage(LockstepSettings{});
  stage.join(1, "/a");
  stage.wall = kSecond;
  stage.join(2, "/b");
  EXPECT_EQ(stage.session.nextWake(), 3 * kSecond);
  stage.wall = 3 * kSecond - 1;
  stage.poll();
  EXPECT_EQ(stage.point(1), "none");
  stage.wall = 3 * kSecond;
  stage.poll();
  EXPECT_EQ(stage.point(1), "1000+0");
  ASSERT_EQ(stage.session.status().not_repeatable.size(), 1U);
  EXPECT_NE(stage.session.status().not_repeatable[0].find("no participants are named"),
            std::string::npos);
}

TEST(Start, OneThatDiesBeforeIsMissingAgainAndNothingIsDegraded) {
  Stage stage(named({"/a", "/b"}));
  stage.join(1, "/a");
  stage.cut(1);
  stage.join(2, "/b");
  EXPECT_EQ(stage.point(2), "none");
  EXPECT_TRUE(stage.session.status().degraded.empty());
  stage.join(3, "/a");
  EXPECT_EQ(stage.point(2), "1000+0");
  EXPECT_EQ(stage.point(3), "1000+0");
}

// ---- leaps -----------------------------------------------------------------------------------

TEST(Leaps, GoToTheSmallestWakeUpOfAllAndGrantOnlyThoseOfThatInstant) {
  Stage stage(named({"/a", "/b", "/c"}));
  for (const ConnectionId id : {1U, 2U, 3U}) {
    stage.join(id, std::string("/") + static_cast<char>('a' + id - 1));
  }
  for (const ConnectionId id : {1U, 2U, 3U}) {
    stage.grant(id);
  }
  stage.report(1, 5 * kSecond);
  stage.report(2, 3 * kSecond);
  EXPECT_EQ(stage.point(2), "none");  // /c is still at work
  stage.report(3, 3 * kSecond);
  EXPECT_EQ(stage.point(1), "none");
  EXPECT_EQ(stage.point(2), "3000+0");
  EXPECT_EQ(stage.point(3), "3000+0");
  stage.report(2, 3 * kSecond);
  stage.report(3, kNever);
  EXPECT_EQ(stage.point(2), "3000+1");  // due at this very instant
  EXPECT_EQ(stage.point(3), "none");
  stage.report(2, kNever);
  EXPECT_EQ(stage.point(1), "5000+0");
  EXPECT_EQ(stage.session.status().leaps, 2U);
  EXPECT_EQ(stage.session.status().rounds, 4U);
}

TEST(Leaps, ThousandsOfMicrostepsAtOneInstantAreNoLoopIfAllowed) {
  Alone alone(kSecond);
  for (int k = 0; k < 5'000; ++k) {
    ASSERT_TRUE(alone.grant(1));
    alone.report(1, kSecond);
  }
  EXPECT_EQ(alone.session.microstep(), 5'001U);
}

TEST(Leaps, NobodyIsGrantedBeyondTheEndOfTime) {
  Alone alone(kLastInstant + 1);
  EXPECT_EQ(alone.phase(), "idle");
  EXPECT_EQ(alone.session.now(), kSecond);
}

TEST(Leaps, IdleEndsWithAKnock) {
  Alone alone(kNever);
  EXPECT_EQ(alone.phase(), "idle");
  EXPECT_EQ(alone.session.nextWake(), kNever);
  alone.frame(1, wire::Knock{});
  EXPECT_EQ(alone.point(1), "1000+1");
  EXPECT_EQ(alone.session.status().not_repeatable,
            std::vector<std::string>{"'/a' had input from outside at 1 s"});
}

TEST(Leaps, AKnockThatCrossedAGrantIsServedAfterIt) {
  Pair stage;
  stage.frame(1, wire::Knock{});
  stage.report(1, 9 * kSecond);
  EXPECT_EQ(stage.point(1), "none");
  stage.report(2, 2 * kSecond);
  EXPECT_EQ(stage.point(1), "1000+1");  // before the leap to 2 s
  EXPECT_EQ(stage.point(2), "none");
}

// ---- silence and standstill ------------------------------------------------------------------

TEST(Silence, IsNamedOnceWithWhatIsOwedAndSoIsItsEnd) {
  Pair stage;
  stage.report(1, kNever, {advertise(1, "/x"), wire::Send{1, 0, 0, "early"}});
  stage.report(2, 4 * kSecond, {subscribe(2, "/x")});
  stage.grant(1);
  stage.grant(2);
  stage.report(1, kNever, {wire::Send{1, 0, 0, "data"}});
  stage.report(2, kNever);
  stage.grant(2);
  EXPECT_EQ(stage.session.nextWake(), 10 * kSecond);
  stage.wall = 2 * kSecond;
  stage.poll();
  EXPECT_EQ(stage.phase(), "waiting");
  const auto waiting = stage.session.status().waiting_for;
  ASSERT_EQ(waiting.size(), 1U);
  EXPECT_EQ(waiting[0].name, "/b");
  EXPECT_EQ(waiting[0].since, 0);
  EXPECT_EQ(waiting[0].owes, "the report of round 3 (1 message)");
  stage.wall = 12 * kSecond;
  stage.poll();
  EXPECT_TRUE(
      stage.said("'/b' has been silent for 12 s of wall time; it owes the report of round "
                 "3 (1 message) at 1 s",
                 LockstepMessage::Level::kWarn));
  stage.messages.clear();
  stage.wall = 40 * kSecond;
  stage.poll();
  EXPECT_TRUE(stage.messages.empty());
  stage.report(2, kNever);
  EXPECT_TRUE(stage.said("'/b' answered after 40 s of wall time"));
  EXPECT_TRUE(stage.session.status().degraded.empty());
}

TEST(Silence, CanMeanToBeDropped) {
  LockstepSettings settings = named({"/a", "/b"});
  settings.on_silence = OnSilence::kDrop;
  Stage stage(settings);
  stage.join(1, "/a");
  stage.join(2, "/b");
  stage.grant(1);
  stage.report(1, 3 * kSecond);
  stage.wall = 10 * kSecond;
  stage.poll();
  EXPECT_TRUE(stage.closed[2]);
  EXPECT_EQ(stage.end[2], "it was dropped: silent for 10 s of wall time");
  EXPECT_EQ(stage.point(1), "3000+0");
  EXPECT_EQ(stage.session.status().degraded.size(), 1U);
}

TEST(Silence, OfAnyLengthIsAllowedByALimitOfZero) {
  LockstepSettings settings = named({"/a"});
  settings.silence_limit = 0.0;
  Stage stage(settings);
  stage.join(1, "/a");
  EXPECT_EQ(stage.session.nextWake(), kNever);
}

}  // namespace
}  // namespace move_base_abstract::lockstep_rounds_test
