// When the time master publishes, and random sequences against a model; wall time is an argument,
// so nothing here waits.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <vector>

#include "clock/time_master.h"
#include "night.h"
#include "time_master_adversary.h"

namespace move_base_abstract {
namespace {

struct Message {
  Nanoseconds wall;
  Nanoseconds time;
  bool operator==(const Message& other) const { return wall == other.wall && time == other.time; }
};

std::ostream& operator<<(std::ostream& out, const Message& message) {
  return out << "{wall " << message.wall - kBoot << ", time " << message.time << "}";
}

/** @brief Poll at each wake until @p end, as a node that is never late does. */
std::vector<Message> play(TimeMaster& master, Nanoseconds from, Nanoseconds end) {
  std::vector<Message> messages;
  for (Nanoseconds wall = from; wall < end; wall = std::max(wall, master.nextWake())) {
    if (const auto time = master.poll(wall)) {
      messages.push_back({wall, *time});
    }
  }
  return messages;
}

TEST(Publication, TheFirstMessageIsDueAtOnceWithTheStartTime) {
  TimeMaster master(with(1.0), kBoot);
  EXPECT_EQ(master.nextWake(), kBoot);
  EXPECT_EQ(master.poll(kBoot), kSecond);
  EXPECT_FALSE(master.poll(kBoot));
}

TEST(Publication, GoesByTheFinestStepWhereTheRateAllows) {
  TimeMaster master(with(2.0), kBoot);
  const auto messages = play(master, kBoot, kBoot + 14'999'999);
  const std::vector<Message> expected = {{kBoot, kSecond},
                                         {kBoot + 5'000'000, kSecond + 10'000'000},
                                         {kBoot + 10'000'000, kSecond + 20'000'000}};
  EXPECT_EQ(messages, expected);
}

TEST(Publication, NeverExceedsTheWallRate) {
  TimeMaster master(with(1000.0), kBoot);
  const auto messages = play(master, kBoot, kBoot + kSecond);
  ASSERT_EQ(messages.size(), 500u);
  for (std::size_t k = 1; k < messages.size(); ++k) {
    EXPECT_EQ(messages[k].wall - messages[k - 1].wall, 2'000'000);
    EXPECT_EQ(messages[k].time - messages[k - 1].time, 2 * kSecond);
  }
}

TEST(Publication, ALatePollDoesNotMakeTheNextComeTooSoon) {
  TimeMaster master(with(1000.0), kBoot);
  master.poll(kBoot);
  ASSERT_TRUE(master.poll(kBoot + 3'900'000));
  EXPECT_FALSE(master.poll(kBoot + 5'899'999));
  EXPECT_TRUE(master.poll(kBoot + 5'900'000));
}

TEST(Publication, RepeatsThePresentWhilePaused) {
  TimeMaster master(with(1.0), kBoot);
  master.poll(kBoot);
  master.pause(kBoot + 3'333'333);
  const auto messages = play(master, kBoot + 3'333'333, kBoot + 120'000'000);
  const Nanoseconds present = kSecond + 3'333'333;
  const std::vector<Message> expected = {
      {kBoot + 3'333'333, present}, {kBoot + 53'333'333, present}, {kBoot + 103'333'333, present}};
  EXPECT_EQ(messages, expected);
}

TEST(Publication, RepeatsThePresentWhileFrozenByAHold) {
  TimeMaster master(with(10.0, 0.0), kBoot);
  master.hold("a", 0.12, kBoot);
  const auto messages = play(master, kBoot, kBoot + 121'500'000);
  const std::vector<Message> expected = {{kBoot, kSecond},
                                         {kBoot + 50'000'000, kSecond},
                                         {kBoot + 100'000'000, kSecond},
                                         {kBoot + 121'000'000, kSecond + 10'000'000}};
  EXPECT_EQ(messages, expected);
}

TEST(Publication, RepeatsTheLastTimeWhereTheNextStepIsFarOff) {
  TimeMaster master(with(0.1), kBoot);  // 10 ms of simulated time take 100 ms
  const auto messages = play(master, kBoot, kBoot + 149'999'999);
  const std::vector<Message> expected = {
      {kBoot, kSecond}, {kBoot + 50'000'000, kSecond}, {kBoot + 100'000'000, kSecond + 10'000'000}};
  EXPECT_EQ(messages, expected);
}

TEST(Publication, AStopIsPublishedExactlyAndAtOnce) {
  TimeMaster master(with(1.0), kBoot);
  master.step(13'000'001, kBoot);
  const auto messages = play(master, kBoot, kBoot + 60'000'000);
  const std::vector<Message> expected = {{kBoot, kSecond},
                                         {kBoot + 10'000'000, kSecond + 10'000'000},
                                         {kBoot + 13'000'001, kSecond + 13'000'001}};
  EXPECT_EQ(messages, expected);
}

TEST(Publication, AStopRightAfterAMessageWaitsForTheWallRate) {
  TimeMaster master(with(1000.0), kBoot);
  master.step(10, kBoot);
  const auto messages = play(master, kBoot, kBoot + 10'000'000);
  const std::vector<Message> expected = {{kBoot, kSecond}, {kBoot + 2'000'000, kSecond + 10}};
  EXPECT_EQ(messages, expected);
}

TEST(Publication, WakesForTheEndOfAHold) {
  TimeMaster master(with(1.0), kBoot);
  master.hold("a", 1e-3, kBoot);
  master.poll(kBoot);
  EXPECT_EQ(master.nextWake(), kBoot + 1'000'000);
}

TEST(Publication, WakesForAStop) {
  TimeMaster master(with(1.0), kBoot);
  master.poll(kBoot);
  master.step(1'000'000, kBoot);
  EXPECT_EQ(master.nextWake(), kBoot + 1'000'000);
}

// ---- achieved factor -----------------------------------------------------------------------

TEST(AchievedFactor, IsTheOneOfTheLastSecond) {
  TimeMaster master(with(10.0), kBoot);
  EXPECT_EQ(master.achievedFactor(), 0.0);
  play(master, kBoot, kBoot + 3 * kSecond);
  EXPECT_NEAR(master.achievedFactor(), 10.0, 1e-6);
  master.setFactor(20.0, kBoot + 3 * kSecond);
  play(master, kBoot + 3 * kSecond, kBoot + 3 * kSecond + kSecond / 2);
  EXPECT_NEAR(master.achievedFactor(), 15.0, 0.5);
  play(master, kBoot + 3 * kSecond + kSecond / 2, kBoot + 5 * kSecond);
  EXPECT_NEAR(master.achievedFactor(), 20.0, 1e-6);
  master.pause(kBoot + 5 * kSecond);
  play(master, kBoot + 5 * kSecond, kBoot + 7 * kSecond);
  EXPECT_EQ(master.achievedFactor(), 0.0);
}

// ---- adversarial sequences against a model that counts every nanosecond ----------------------

TEST(Adversary, RandomSequencesEqualTheModelWhenHoldsSlowDown) {
  for (int seed = 0; seed < times(4, 40); ++seed) {
    Adversary(static_cast<unsigned>(seed), 0.7).play(20'000);
  }
}

TEST(Adversary, RandomSequencesEqualTheModelWhenHoldsFreeze) {
  for (int seed = 100; seed < times(104, 140); ++seed) {
    Adversary(static_cast<unsigned>(seed), 0.0).play(20'000);
  }
}

}  // namespace
}  // namespace move_base_abstract
