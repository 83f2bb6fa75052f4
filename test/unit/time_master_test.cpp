// The time master's rules; wall time is an argument, so nothing here waits.
#include "clock/time_master.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "time_master_adversary.h"

namespace move_base_abstract {
namespace {

using Kind = TimeMaster::Event::Kind;

// ---- integration ---------------------------------------------------------------------------

TEST(Integration, StartsAtOneSecondAndRunsAtFactorTimesWall) {
  TimeMaster master(with(10.0), kBoot);
  EXPECT_EQ(master.now(), 1 * kSecond);
  master.advance(kBoot + 3 * kSecond);
  EXPECT_EQ(master.now(), 31 * kSecond);
}

TEST(Integration, TenDaysAtOneThousandAreExactToTheNanosecond) {
  TimeMaster master(with(1000.0), kBoot);
  const Nanoseconds ten_days = 864'000 * kSecond;
  master.advance(kBoot + ten_days);
  EXPECT_EQ(master.now(), kSecond + 1000 * ten_days);
}

TEST(Integration, OfAGapOnlyAsMuchCountsAsMayAndItIsToldOnce) {
  TimeMaster::Settings settings = with(20.0);
  settings.longest_gap = 0.25;
  TimeMaster master(settings, kBoot);
  master.advance(kBoot + kSecond / 4);
  EXPECT_EQ(master.now(), 6 * kSecond);  // a gap that is just as long as it may be
  EXPECT_TRUE(master.takeEvents().empty());
  master.hold("planner", 1.0, kBoot + kSecond / 4);
  const Nanoseconds woken = kBoot + kSecond / 4 + 8 * kSecond;
  EXPECT_EQ(master.poll(woken), 11 * kSecond);  // not 166 s; the hold ended meanwhile
  const std::vector<TimeMaster::Event> events = master.takeEvents();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].kind, Kind::kGap);
  EXPECT_EQ(events[0].time, 6 * kSecond);
  EXPECT_EQ(events[0].left_out, 7 * kSecond + 3 * kSecond / 4);
  EXPECT_EQ(events[1].kind, Kind::kHoldExpired);
  EXPECT_LT(master.achievedFactor(), 2.0);
  master.pause(woken);
  master.advance(woken + 100 * kSecond);
  EXPECT_TRUE(master.takeEvents().empty());  // nothing is lost while time stands
}

TEST(AchievedFactor, IsThatOfTheLimitHoweverRarelyTimeLeaps) {
  AchievedFactor factor;
  Nanoseconds leap = kBoot;  // 60 s of simulated time, and then 2 s, at 20 times real time
  Nanoseconds time = kSecond;
  for (int k = 0; k < 20; ++k) {
    const Nanoseconds distance = (k % 2 == 0 ? 60 : 2) * kSecond;
    for (Nanoseconds wall = leap; wall < leap + distance / 20; wall += kSecond / 50) {
      factor.look(wall, time, 20.0, true);
      if (wall > kBoot + kSecond) {
        EXPECT_NEAR(factor.at(wall), 20.0, 1.0);
      }
    }
    leap += distance / 20;
    time += distance;
  }
}

TEST(AchievedFactor, IsTakenFromLeapToLeapWhileNodesComputeAndIsNoneWhereTimeStands) {
  AchievedFactor factor;
  Nanoseconds wall = kBoot;
  for (int k = 0; k < 500; ++k, wall += kSecond / 50) {  // 30 s each 1.5 s
    factor.look(wall, kSecond + k / 75 * 30 * kSecond, 0.0, true);
    if (k > 100) {
      EXPECT_NEAR(factor.at(wall), 20.0, 1.0);
    }
  }
  EXPECT_NEAR(factor.at(wall + 10 * kSecond), 3.0, 1.0);  // no longer
  const Nanoseconds stood = kSecond + 499 / 75 * 30 * kSecond;
  for (int k = 0; k < 101; ++k, wall += kSecond / 50) {
    factor.look(wall, stood, 0.0, false);
  }
  EXPECT_EQ(factor.at(wall), 0.0);
}

TEST(Integration, ManySmallAdvancesEqualOneLargeOne) {
  TimeMaster fine(with(0.333333333), kBoot);
  TimeMaster coarse(with(0.333333333), kBoot);
  for (int k = 1; k <= 100'000; ++k) {
    fine.advance(kBoot + 7 * k);
  }
  coarse.advance(kBoot + 700'000);
  EXPECT_EQ(fine.now(), coarse.now());
  EXPECT_EQ(fine.now(), kSecond + 233'333);
}

TEST(Integration, OneMillionRandomFactorChangesEqualTheExactSum) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-2.0, 6.0);
  std::uniform_int_distribution<Nanoseconds> pause(0, 2'000);
  TimeMaster master(with(1.0), kBoot);
  Wide exact = static_cast<Wide>(kSecond) * kFactorUnit;
  FactorUnits units = kFactorUnit;
  Nanoseconds wall = kBoot;
  for (int k = 0; k < 1'000'000; ++k) {
    const Nanoseconds passed = pause(random);
    wall += passed;
    exact += static_cast<Wide>(units) * passed;
    const double factor = std::pow(10.0, exponent(random));
    units = std::llround(factor * 1e9);
    master.setFactor(factor, wall);
    ASSERT_EQ(master.now(), static_cast<Nanoseconds>(exact / kFactorUnit)) << "change " << k;
  }
}

TEST(Integration, AFactorChangeDoesNotMoveThePresent) {
  TimeMaster master(with(7.0), kBoot);
  master.advance(kBoot + 123'456'789);
  const Nanoseconds before = master.now();
  for (double factor : {0.01, 1e6, 3.0}) {
    master.setFactor(factor, kBoot + 123'456'789);
    EXPECT_EQ(master.now(), before);
  }
}

TEST(Integration, AWallInstantBeforeTheLatestNeverMovesTimeBack) {
  TimeMaster master(with(100.0), kBoot);
  master.advance(kBoot + kSecond);
  const Nanoseconds before = master.now();
  for (Nanoseconds wall : {Nanoseconds{0}, kBoot, kBoot + kSecond - 1}) {
    master.advance(wall);
    master.setFactor(1.0, wall);
    EXPECT_EQ(master.now(), before);
  }
}

TEST(Integration, StandsStillAtTheEndOfTimeAndSaysSo) {
  TimeMaster master(with(1e6), kBoot);
  master.advance(kBoot + 1'000'000 * kSecond);
  EXPECT_EQ(master.now(), kLastInstant);
  EXPECT_TRUE(master.paused());
  const auto events = master.takeEvents();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, Kind::kEndOfTime);
  EXPECT_NE(refusal([&] { master.resume(kMost); }).find("2147483647"), std::string::npos);
  EXPECT_NE(refusal([&] { master.step(1, kMost); }).find("at most 0 s"), std::string::npos);
}

// ---- settings and refusals -----------------------------------------------------------------

TEST(Settings, ABadFactorIsRefusedAndTheOldOneStays) {
  TimeMaster master(with(5.0), kBoot);
  for (double bad : {0.0, -1.0, 0.0099, 1000001.0, kNan, kInfinity, -kInfinity}) {
    const std::string text = refusal([&] { master.setFactor(bad, kBoot); });
    EXPECT_NE(text.find("factor must be from 0.01 to 1000000"), std::string::npos) << text;
  }
  EXPECT_EQ(master.wantedFactor(), 5.0);
  EXPECT_EQ(master.effectiveFactor(), 5.0);
}

TEST(Settings, TheEndsOfTheFactorsRangeAreAllowed) {
  TimeMaster master(with(0.01), kBoot);
  master.setFactor(1e6, kBoot + kSecond);
  master.advance(kBoot + kSecond + 3);
  EXPECT_EQ(master.now(), kSecond + kSecond / 100 + 3'000'000);
}

// ---- pause, step, run until ----------------------------------------------------------------

TEST(Pause, StandsStillAndResumesWithoutAJump) {
  TimeMaster master(with(3.0), kBoot);
  master.pause(kBoot + 5);
  EXPECT_TRUE(master.paused());
  EXPECT_EQ(master.effectiveFactor(), 0.0);
  EXPECT_EQ(master.wantedFactor(), 3.0);
  master.resume(kBoot + kSecond);
  EXPECT_EQ(master.now(), kSecond + 15);
  master.advance(kBoot + kSecond + 7);
  EXPECT_EQ(master.now(), kSecond + 36);
}

TEST(Pause, CanBeHadFromTheStart) {
  TimeMaster::Settings settings;
  settings.start_paused = true;
  TimeMaster master(settings, kBoot);
  master.advance(kBoot + kSecond);
  EXPECT_EQ(master.now(), kSecond);
}

TEST(Pause, KeepsTheFractionOfANanosecond) {
  TimeMaster master(with(0.5), kBoot);
  for (int k = 0; k < 10; ++k) {  // ten times half a nanosecond, with a pause after each
    master.pause(kBoot + 100 * k + 1);
    master.resume(kBoot + 100 * k + 100);
  }
  EXPECT_EQ(master.now(), kSecond + 5);
}

TEST(Step, StopsExactlyAtItsTargetHoweverLateTheNextCall) {
  TimeMaster master(with(999'999.999), kBoot);
  master.pause(kBoot + 1);
  const Nanoseconds from = master.now();
  EXPECT_EQ(master.step(1'234'567'891, kBoot + 2), from + 1'234'567'891);
  EXPECT_FALSE(master.paused());
  master.advance(kBoot + 50 * kSecond);
  EXPECT_EQ(master.now(), from + 1'234'567'891);
  EXPECT_TRUE(master.paused());
  EXPECT_FALSE(master.target());
  const auto events = master.takeEvents();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, Kind::kTargetReached);
  EXPECT_EQ(events[0].wall, kBoot + 2 + 1235);  // 1234567891 / 999999.999, rounded up
}

TEST(Step, StartsExactlyFromTheTargetOfTheLastOne) {
  TimeMaster master(with(1e6), kBoot);
  master.pause(kBoot);
  for (int k = 1; k <= 1000; ++k) {
    EXPECT_EQ(master.step(1, kBoot + 10 * k), kSecond + k);
  }
}

TEST(Step, CountsFromTheTargetOfOneStillUnderWay) {
  TimeMaster master(with(1.0), kBoot);
  master.pause(kBoot);
  for (int k = 1; k <= 10; ++k) {
    EXPECT_EQ(master.step(kSecond, kBoot + k), (1 + k) * kSecond);
  }
  master.advance(kBoot + 60 * kSecond);
  EXPECT_EQ(master.now(), 11 * kSecond);
}

TEST(Step, OfARunningClockStopsItAfterTheDuration) {
  TimeMaster master(with(2.0), kBoot);
  EXPECT_EQ(master.step(kSecond, kBoot + kSecond), 4 * kSecond);
  master.advance(kBoot + 9 * kSecond);
  EXPECT_EQ(master.now(), 4 * kSecond);
}

TEST(Step, OfNothingNegativeOrPastTheEndOfTimeIsRefused) {
  TimeMaster master(with(1.0), kBoot);
  const Nanoseconds room = kLastInstant - kSecond;
  for (Nanoseconds bad : {Nanoseconds{0}, Nanoseconds{-1}, room + 1, kMost, -kMost - 1}) {
    const std::string text = refusal([&] { master.step(bad, kBoot); });
    EXPECT_NE(text.find("step: duration must be more than 0"), std::string::npos) << text;
  }
  EXPECT_NE(refusal([&] { master.step(-1, kBoot); }).find("got -0.000000001 s"), std::string::npos);
  EXPECT_FALSE(master.target());
  EXPECT_EQ(master.step(room, kBoot), kLastInstant);
}

TEST(RunUntil, StopsExactlyAndStaysPaused) {
  TimeMaster master(with(7.3), kBoot);
  master.runUntil(100 * kSecond + 1, kBoot);
  EXPECT_EQ(master.target(), 100 * kSecond + 1);
  master.advance(kBoot + 1000 * kSecond);
  EXPECT_EQ(master.now(), 100 * kSecond + 1);
  EXPECT_TRUE(master.paused());
}

TEST(RunUntil, ThePresentPausesAtOnce) {
  TimeMaster master(with(1.0), kBoot);
  master.runUntil(kSecond, kBoot);
  EXPECT_TRUE(master.paused());
  EXPECT_EQ(master.takeEvents().size(), 1u);
}

TEST(RunUntil, ThePastAndBeyondTheEndAreRefused) {
  TimeMaster master(with(1.0), kBoot);
  for (Nanoseconds bad : {kSecond - 1, Nanoseconds{0}, -kMost, kLastInstant + 1, kMost}) {
    const std::string text = refusal([&] { master.runUntil(bad, kBoot); });
    EXPECT_NE(text.find("target must be from the present, 1 s"), std::string::npos) << text;
  }
  EXPECT_FALSE(master.paused());
}

TEST(RunUntil, FollowsAFactorThatChangesOnTheWay) {
  TimeMaster master(with(1.0), kBoot);
  master.runUntil(11 * kSecond, kBoot);
  master.setFactor(100.0, kBoot + kSecond);
  master.advance(kBoot + kSecond + 89'999'999);
  EXPECT_FALSE(master.paused());
  master.advance(kBoot + kSecond + 90'000'000);
  EXPECT_TRUE(master.paused());
  EXPECT_EQ(master.now(), 11 * kSecond);
}

TEST(RunUntil, IsGivenUpByPauseAndByResume) {
  TimeMaster master(with(1.0), kBoot);
  master.runUntil(10 * kSecond, kBoot);
  master.pause(kBoot + kSecond);
  EXPECT_FALSE(master.target());
  master.runUntil(10 * kSecond, kBoot + kSecond);
  master.resume(kBoot + kSecond);
  master.advance(kBoot + 100 * kSecond);
  EXPECT_EQ(master.now(), 101 * kSecond);
}

}  // namespace
}  // namespace move_base_abstract

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
