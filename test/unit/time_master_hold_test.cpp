// Holds of the scaled clock; wall time is an argument, so nothing here waits.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "clock/time_master.h"
#include "time_master_adversary.h"

namespace move_base_abstract {
namespace {

using Kind = TimeMaster::Event::Kind;

TEST(Hold, LimitsTheFactorAndNeverRaisesIt) {
  TimeMaster master(with(10.0, 2.0), kBoot);
  master.hold("a", 60.0, kBoot);
  EXPECT_EQ(master.effectiveFactor(), 2.0);
  master.setFactor(0.5, kBoot);
  EXPECT_EQ(master.effectiveFactor(), 0.5);
  master.setFactor(50.0, kBoot);
  EXPECT_EQ(master.effectiveFactor(), 2.0);
  EXPECT_TRUE(master.release("a", kBoot));
  EXPECT_EQ(master.effectiveFactor(), 50.0);
}

TEST(Hold, ZeroBusyFactorFreezes) {
  TimeMaster master(with(10.0, 0.0), kBoot);
  master.hold("a", 2.0, kBoot);
  master.advance(kBoot + kSecond);
  EXPECT_EQ(master.now(), kSecond);
  EXPECT_FALSE(master.paused());
}

TEST(Hold, TheClockIsBusyUntilTheLastOfSeveralHoldersLetsGo) {
  TimeMaster master(with(10.0, 1.0), kBoot);
  master.hold("b", 60.0, kBoot);
  master.hold("a", 60.0, kBoot);
  EXPECT_TRUE(master.release("b", kBoot + kSecond));
  EXPECT_FALSE(master.release("b", kBoot + kSecond));
  EXPECT_FALSE(master.release("never", kBoot + kSecond));
  EXPECT_EQ(master.effectiveFactor(), 1.0);
  EXPECT_TRUE(master.release("a", kBoot + 2 * kSecond));
  master.advance(kBoot + 3 * kSecond);
  EXPECT_EQ(master.now(), (1 + 2 + 10) * kSecond);
}

TEST(Hold, EndsAtExactlyItsInstantHoweverLateTheNextCallAndIsReported) {
  TimeMaster master(with(1000.0, 0.0), kBoot);
  master.hold("late", 3.0, kBoot);
  master.hold("early", 2.0, kBoot);
  master.advance(kBoot + 10 * kSecond);
  EXPECT_EQ(master.now(), kSecond + 7000 * kSecond);
  const auto events = master.takeEvents();
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].kind, Kind::kHoldExpired);
  EXPECT_EQ(events[0].holder, "early");
  EXPECT_EQ(events[0].wall, kBoot + 2 * kSecond);
  EXPECT_EQ(events[1].holder, "late");
  EXPECT_EQ(events[1].wall, kBoot + 3 * kSecond);
  EXPECT_EQ(events[1].time, kSecond);
  EXPECT_TRUE(master.takeEvents().empty());
  EXPECT_TRUE(master.holds().empty());
}

TEST(Hold, ThoseThatEndAtOneInstantAreReportedInAlphabeticalOrderAfterAStopOfThatInstant) {
  TimeMaster master(with(1.0, 1.0), kBoot);
  master.runUntil(3 * kSecond, kBoot);
  for (const char* holder : {"b", "c", "a"}) {
    master.hold(holder, 2.0, kBoot);
  }
  master.advance(kBoot + 5 * kSecond);
  const auto events = master.takeEvents();
  ASSERT_EQ(events.size(), 4u);
  EXPECT_EQ(events[0].kind, Kind::kTargetReached);
  EXPECT_EQ(events[1].holder + events[2].holder + events[3].holder, "abc");
  EXPECT_EQ(events[3].wall, kBoot + 2 * kSecond);
}

TEST(Hold, IsOverAtTheInstantOfItsEndAlsoForWhoReleasesThen) {
  TimeMaster master(with(10.0, 0.0), kBoot);
  master.hold("a", 2.0, kBoot);
  EXPECT_FALSE(master.release("a", kBoot + 2 * kSecond));
  EXPECT_EQ(master.takeEvents().size(), 1u);
  EXPECT_EQ(master.effectiveFactor(), 10.0);
  master.hold("a", 2.0, kBoot + 2 * kSecond);
  EXPECT_TRUE(master.release("a", kBoot + 4 * kSecond - 1));
  EXPECT_TRUE(master.takeEvents().empty());
}

TEST(Hold, AgainByTheSameNameExtendsAndNeverShortens) {
  TimeMaster master(with(10.0), kBoot);
  master.hold("a", 5.0, kBoot);
  master.hold("a", 5.0, kBoot + 4 * kSecond);
  master.hold("a", 1.0, kBoot + 4 * kSecond);
  ASSERT_EQ(master.holds().size(), 1u);
  EXPECT_EQ(master.holds()[0].remaining, 5 * kSecond);
  master.advance(kBoot + 9 * kSecond - 1);
  EXPECT_TRUE(master.takeEvents().empty());
  master.advance(kBoot + 9 * kSecond);
  EXPECT_EQ(master.takeEvents().size(), 1u);
}

TEST(Hold, ExpiresWhilePausedToo) {
  TimeMaster master(with(10.0, 0.0), kBoot);
  master.hold("a", 1.0, kBoot);
  master.pause(kBoot);
  master.resume(kBoot + 2 * kSecond);
  EXPECT_EQ(master.effectiveFactor(), 10.0);
}

TEST(Hold, DelaysAStepWhoseEndStaysExact) {
  TimeMaster master(with(10.0, 0.0), kBoot);
  master.step(5 * kSecond, kBoot);
  master.hold("a", 4.0, kBoot + kSecond / 10);
  master.advance(kBoot + 4 * kSecond);
  EXPECT_EQ(master.now(), 2 * kSecond);
  master.advance(kBoot + 60 * kSecond);
  EXPECT_EQ(master.now(), 6 * kSecond);
}

TEST(Hold, BadHoldersAndTimeoutsAreRefused) {
  TimeMaster master(with(10.0), kBoot);
  EXPECT_NE(refusal([&] { master.hold("", 1.0, kBoot); }).find("got an empty one"),
            std::string::npos);
  for (double bad : {0.0, -1.0, 86401.0, kNan, kInfinity}) {
    const std::string text = refusal([&] { master.hold("a", bad, kBoot); });
    EXPECT_NE(text.find("hold by 'a': timeout must be more than 0 and at most 86400 s"),
              std::string::npos)
        << text;
  }
  EXPECT_TRUE(master.holds().empty());
}

TEST(Hold, NearTheEndOfWallTimeDoesNotOverflow) {
  TimeMaster master(with(1.0, 0.0), kMost - kSecond);
  master.hold("a", 86400.0, kMost - kSecond);
  EXPECT_EQ(master.holds()[0].remaining, kSecond);
  master.advance(kMost - 1);
  EXPECT_EQ(master.now(), kSecond);
}

}  // namespace
}  // namespace move_base_abstract
