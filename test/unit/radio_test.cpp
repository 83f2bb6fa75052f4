// The radio between hosts: hand-made cases to the nanosecond, and the formulas it stands for.
#include "lockstep/radio/radio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "lockstep/radio/draws.h"
#include "lockstep/radio/link_watch.h"
#include "lockstep/radio/patterns.h"
#include "radio_motion.h"

namespace move_base_abstract::radio {
namespace {

using Kind = Radio::Outcome::Kind;
constexpr Nanoseconds kSecond = kNanosecondsPerSecond;

/** A radio of two hosts at a distance [m] whose link is as @p keys say. */
struct Two {
  explicit Two(const std::string& keys, double distance = 0.0, std::uint64_t seed = 1)
      : radio(networkOf({"seed " + std::to_string(seed), "host base at 0 0 /base",
                         "host robot at " + std::to_string(distance) + " 0 /robot/**",
                         "link base robot " + keys})),
        base(radio.hosts().of("/base")),
        robot(radio.hosts().of("/robot/move_base")) {}
  Radio::Outcome send(std::size_t bytes, Nanoseconds now) {
    return radio.send(base, robot, bytes, ++ticket, now);
  }
  Radio radio;
  HostId base, robot;
  Ticket ticket = 0;
};

TEST(Radio, ADelayOfMessageSizeAndLine) {
  Two two("delay 20000000 20000000 rate 1000000");                         // 20 ms, 1 Mbit/s
  EXPECT_EQ(two.send(125, kSecond).at, kSecond + 1'000'000 + 20'000'000);  // 1000 bits: 1 ms
  // The next one waits until the first has been sent; not until it has arrived.
  EXPECT_EQ(two.send(1, kSecond).at, kSecond + 1'000'000 + 8'000 + 20'000'000);
  // The other direction is free.
  EXPECT_EQ(two.radio.send(two.robot, two.base, 1, 9, kSecond).at, kSecond + 8'000 + 20'000'000);
  EXPECT_EQ(two.send(0, 2 * kSecond).at, 2 * kSecond + 20'000'000);
}

TEST(Radio, ASendingTimeIsRoundedUp) {
  Two two("rate 3");
  EXPECT_EQ(two.send(1, 0).at, 2'666'666'667);
}

TEST(Radio, ABufferThatIsFullLoses) {
  Two two("rate 8 buffer 3");  // a byte a second
  EXPECT_EQ(two.send(2, 0).at, 2 * kSecond);
  EXPECT_STREQ(two.send(2, 0).reason, lost_by::kBuffer);
  EXPECT_EQ(two.send(2, kSecond).at, 4 * kSecond);
}

TEST(Radio, OutOfRangeBeginsBehindTheRange) {
  EXPECT_EQ(Two("range 150", 150.0).send(1, 0).kind, Kind::kArrives);
  EXPECT_STREQ(Two("range 150", 150.001).send(1, 0).reason, lost_by::kRange);
}

TEST(Radio, HostsWithoutALinkHearNothing) {
  Radio radio(networkOf({"host a at 0 0 /a", "host b at 0 0 /b", "host c at 0 0 /c", "link a b"}));
  const HostId a = radio.hosts().of("/a"), b = radio.hosts().of("/b"), c = radio.hosts().of("/c");
  EXPECT_EQ(radio.send(a, b, 1, 1, 0).kind, Kind::kArrives);
  EXPECT_EQ(radio.send(b, a, 1, 2, 0).kind, Kind::kArrives);
  EXPECT_STREQ(radio.send(a, c, 1, 3, 0).reason, lost_by::kNoLink);
}

TEST(Radio, WallsCostMetres) {
  const std::vector<std::string> lines = {"host a at 0.5 0.5 /a", "host b at 8.5 0.5 /b",
                                          "walls 0 0 1 10 10", "wall 0 2 4 6 7",
                                          "link a b range 12 wall 2"};
  Radio radio(networkOf(lines));
  const HostId a = radio.hosts().of("/a"), b = radio.hosts().of("/b");
  EXPECT_EQ(radio.hosts().network().walls.between({0.5, 0.5}, {8.5, 0.5}), 2);
  EXPECT_EQ(radio.send(a, b, 1, 1, 0).kind, Kind::kArrives);  // 8 m and 2 walls are 12 m
  auto more = lines;
  more.insert(more.begin() + 4, "wall 0 5 6");  // thicker, no third one
  more.back() = "link a b range 11.999 wall 2";
  Radio other(networkOf(more));
  EXPECT_STREQ(other.send(other.hosts().of("/a"), other.hosts().of("/b"), 1, 1, 0).reason,
               lost_by::kRange);
}

TEST(Radio, WallsAreSeenFromBothSidesAndFromFarAway) {
  Walls walls({-1.0, -1.0}, 0.5, 40, 40);
  for (std::int32_t row = 0; row < 40; ++row) {
    walls.add(row, 10, 11);
  }
  walls.add(39, 0, 10);
  for (const Place far : {Place{1e9, 3.0}, Place{30.0, -7.0}, Place{18.0, 12.0}}) {
    EXPECT_EQ(walls.between({0.0, 0.0}, far), 1) << far.x;
    EXPECT_EQ(walls.between(far, {0.0, 0.0}), 1) << far.x;
  }
  EXPECT_EQ(walls.between({-1e12, 50.0}, {1e12, 50.0}), 0);
  EXPECT_EQ(walls.between({5.0, 0.0}, {6.0, 0.0}), 0);
  EXPECT_THROW(walls.add(0, 39, 41), std::invalid_argument);
}

// ---- chance ------------------------------------------------------------------------------------

/** Lost ones of a thousand, each with its interval: five standard deviations of the binomial. */
void expectLosses(const std::string& keys, double distance, double probability) {
  constexpr int kCount = 4000;
  Two two(keys, distance, 7);
  int lost = 0;
  for (int k = 0; k < kCount; ++k) {
    lost += two.send(10, k * kSecond).kind == Kind::kLost ? 1 : 0;
  }
  const double mean = kCount * probability;
  EXPECT_LE(std::fabs(lost - mean), 5.0 * std::sqrt(mean * (1.0 - probability)))
      << keys << " at " << distance << ": " << lost << " of " << kCount;
}

TEST(Radio, TheLossCurveIsThatOfTheTable) {
  const std::string table = "table 3 50 0 100 0.2 150 1";
  for (const auto& [distance, probability] : std::vector<std::pair<double, double>>{{0, 0},
                                                                                    {50, 0},
                                                                                    {60, 0.04},
                                                                                    {75, 0.1},
                                                                                    {100, 0.2},
                                                                                    {110, 0.36},
                                                                                    {140, 0.84},
                                                                                    {149, 0.984},
                                                                                    {150, 1},
                                                                                    {1000, 1}}) {
    expectLosses(table, distance, probability);
  }
  expectLosses("loss 0.01", 5.0, 0.01);
}

TEST(Radio, TheLossCurveIsThatOfThePathLoss) {
  // 20 dBm - 40 dB - 30 log10(d) dBm against -80 dBm, spread by 6 dB: half is lost at 100 m.
  const std::string path = "path 20 -80 3 1 40 6";
  for (const double distance : {10.0, 50.0, 80.0, 100.0, 130.0, 200.0, 400.0}) {
    const double excess = 20.0 - 40.0 - 30.0 * std::log10(distance) + 80.0;
    expectLosses(path, distance, 0.5 * std::erfc(excess / 6.0 / std::sqrt(2.0)));
  }
  expectLosses("path 20 -80 3 1 40 0", 99.0, 0.0);
  expectLosses("path 20 -80 3 1 40 0", 101.0, 1.0);
}

TEST(Radio, OwnFunctionsAreThoseOfTheLibraryButForTheLastDigits) {
  for (double value = 1e-9; value < 1e9; value *= 1.37) {
    EXPECT_NEAR(decimalLogarithm(value), std::log10(value), 1e-14) << value;
  }
  for (double value = -4.99; value < 5.0; value += 0.01) {
    EXPECT_NEAR(normalBelow(value), 0.5 * std::erfc(-value / std::sqrt(2.0)), 1e-10) << value;
  }
  EXPECT_EQ(decimalLogarithm(1.0), 0.0);
  EXPECT_EQ(normalBelow(-5.0), 0.0);
  EXPECT_EQ(normalBelow(5.0), 1.0);
  EXPECT_EQ(normalBelow(0.0), 0.5);
}

TEST(Radio, DelaysAreEvenWithinTheirBounds) {
  Two two("delay 5000000 50000000");
  double sum = 0.0;
  for (int k = 0; k < 4000; ++k) {
    const Nanoseconds delay = two.send(10, k * kSecond).at - k * kSecond;
    ASSERT_GE(delay, 5'000'000);
    ASSERT_LE(delay, 50'000'000);
    sum += static_cast<double>(delay);
  }
  // Five standard deviations of the mean: 45 ms / sqrt(12) / sqrt(4000).
  EXPECT_NEAR(sum / 4000.0, 27.5e6, 5.0 * 45e6 / std::sqrt(12.0 * 4000.0));
}

TEST(Radio, NumbersFollowFromTheKeyAlone) {
  const std::uint64_t link = linkKey(1, "robot_1", "base");
  EXPECT_EQ(link, 18198162814942311689U);  // the same on every computer
  EXPECT_EQ(draw(link, 0, 0, Purpose::kLoss), 16361053431391504414U);
  EXPECT_NE(link, linkKey(1, "base", "robot_1"));
  EXPECT_NE(link, linkKey(2, "robot_1", "base"));
  EXPECT_NE(linkKey(1, "a", "bc"), linkKey(1, "ab", "c"));
  EXPECT_EQ(between(0, 3, 9), 3);
  EXPECT_EQ(between(~std::uint64_t{0}, 3, 9), 9);
  EXPECT_FALSE(happens(0, 0.0));
  EXPECT_TRUE(happens(~std::uint64_t{0}, 1.0));
  // What one link draws does not depend on what others do.
  Two alone("loss 0.5"), disturbed("loss 0.5");
  for (int k = 0; k < 100; ++k) {
    disturbed.radio.send(disturbed.robot, disturbed.base, 1, 1000, k);
    EXPECT_EQ(alone.send(1, k).kind, disturbed.send(1, k).kind) << k;
  }
}

/** Mean wait of an M/D/1 queue: rho / (2 mu (1 - rho)) (Pollaczek, Khinchine). */
TEST(Radio, ABusyLinkIsAnMD1Queue) {
  for (const double load : {0.5, 0.8}) {
    Two two("rate 8000");  // 1 ms a byte: messages of 10 bytes take 10 ms
    const double service = 0.01;
    double now = 0.0, waits = 0.0;
    constexpr int kCount = 200'000;
    for (int k = 0; k < kCount; ++k) {
      const double even =
          (static_cast<double>(draw(99, static_cast<std::uint64_t>(k), 0, Purpose::kDelay) >> 11U) +
           0.5) *
          0x1p-53;
      now -= std::log(even) * service / load;
      const auto at = static_cast<Nanoseconds>(now * 1e9);
      waits += static_cast<double>(two.send(10, at).at - at) * 1e-9 - service;
    }
    const double expected = load * service / (2.0 * (1.0 - load));
    EXPECT_NEAR(waits / kCount, expected, 0.03 * expected) << load;
  }
}

// ---- what is sent again ------------------------------------------------------------------------

TEST(Radio, RetriesBackOffAndKeepTheOrder) {
  Two two("range 10 lost retry retry 200000000 attempts 3 delay 1000 1000", 20.0);
  EXPECT_EQ(two.send(1, 0).kind, Kind::kWaits);
  EXPECT_EQ(two.send(1, 5).kind, Kind::kWaits);  // behind the first
  EXPECT_EQ(two.radio.nextLook(), kSecond / 5);
  EXPECT_TRUE(two.radio.look(kSecond / 5).empty());
  EXPECT_EQ(two.radio.nextLook(), 3 * kSecond / 5);  // twice as long after the second try
  const auto decided = two.radio.look(3 * kSecond / 5);
  ASSERT_EQ(decided.size(), 1U);
  EXPECT_EQ(decided[0].ticket, 1U);
  EXPECT_STREQ(decided[0].outcome.reason, lost_by::kRange);
  EXPECT_EQ(two.radio.nextLook(), 4 * kSecond / 5);  // of the second message, tried at 0.6 s
}

TEST(Radio, ALostMessageComesLaterAndInOrder) {
  Two two("loss 0.5 lost retry retry 1000000 attempts 64 delay 0 5000000");
  Nanoseconds latest = 0;
  Ticket next = 1;
  const auto arrives = [&](Ticket ticket, const Radio::Outcome& outcome) {
    EXPECT_EQ(ticket, next++);
    EXPECT_EQ(outcome.kind, Kind::kArrives);
    EXPECT_GE(outcome.at, latest);
    latest = outcome.at;
  };
  for (int k = 0; k < 200; ++k) {
    const Radio::Outcome outcome = two.send(1, k);
    if (outcome.kind != Kind::kWaits) {
      arrives(two.ticket, outcome);
    }
  }
  while (two.radio.nextLook() != kNever) {
    for (const auto& one : two.radio.look(two.radio.nextLook())) {
      arrives(one.ticket, one.outcome);
    }
  }
  EXPECT_EQ(next, 201U);
}

/** A robot that drives from 20 m to 5 m with 10 m/s, from 1 s on, is within 10 m at 2 s. */
struct Driving {
  explicit Driving(const std::string& keys)
      : radio(networkOf({"host base at 0 0 /base", "host robot_* robot /robot_*/**",
                         "link base robot_* range 10 " + keys})),
        base(radio.hosts().of("/base")),
        robot(radio.hosts().of("/robot_7/move_base")) {}
  void drive(Nanoseconds begin) {
    const HostId host = radio.hosts().move(
        "robot_7", motion::Motion(piece(begin, 20, -10) + piece(begin + 3 * kSecond / 2, 5, 0)));
    EXPECT_EQ(host, robot);
    radio.moved(host, begin);
  }
  Radio radio;
  HostId base, robot;
};

TEST(Radio, AQueueWaitsUntilTheRobotIsInRange) {
  Driving one("lost queue delay 7 7");
  EXPECT_EQ(one.radio.hosts().name(one.robot), "robot_7");
  EXPECT_EQ(one.radio.send(one.base, one.robot, 1, 1, 0).kind, Kind::kWaits);
  EXPECT_EQ(one.radio.nextLook(), kNever);  // it stands, for all that is known: nothing can come
  one.drive(kSecond);
  std::vector<Radio::Decided> decided;
  int looks = 0;
  for (; decided.empty(); ++looks) {
    decided = one.radio.look(one.radio.nextLook());
  }
  EXPECT_EQ(looks, 10);  // at 1.1 s, 1.2 s, ...
  EXPECT_EQ(decided[0].outcome.at, 2 * kSecond + 7);
  EXPECT_EQ(one.radio.nextLook(), kNever);
}

TEST(Radio, LinksComeUpToTheNanosecond) {
  Driving one("");
  LinkWatch watch(one.radio.hosts());
  watch.meet(0);
  auto changes = watch.take();
  ASSERT_EQ(changes.size(), 1U);  // what it is at first
  EXPECT_FALSE(changes[0].is_up);
  EXPECT_EQ(watch.next(), kNever);
  one.drive(kSecond + 3);
  watch.moved(one.robot, kSecond + 3);
  EXPECT_EQ(watch.next(), 2 * kSecond + 3);
  watch.advance(2 * kSecond + 2);
  EXPECT_TRUE(watch.take().empty());
  watch.advance(9 * kSecond);
  changes = watch.take();
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].at, 2 * kSecond + 3);
  EXPECT_TRUE(changes[0].is_up);
  EXPECT_TRUE(watch.isUp(one.robot, one.base));
  EXPECT_EQ(watch.next(), kNever);
}

TEST(Radio, PatternsOfNodes) {
  EXPECT_EQ(matched("/robot_*/**", "/robot_12/a/b"), "12");
  EXPECT_EQ(matched("/*/move_base", "/r/move_base"), "r");
  EXPECT_EQ(matched("/**/planner", "/a/b/planner"), "");
  EXPECT_FALSE(matched("/robot_*", "/robot_1/move_base"));
  EXPECT_FALSE(matched("/robot_*/**", "/base"));
  EXPECT_FALSE(matched("/base", "/base2"));
  EXPECT_EQ(filled("robot_*", "12"), "robot_12");
}

TEST(Radio, LinesThatAreNoneAreRefused) {
  for (const char* line : {"",
                           "what",
                           "seed",
                           "seed x",
                           "seed 1 2",
                           "host a",
                           "host a on /a",
                           "host a at 1 /a",
                           "link a",
                           "link a b loss 2",
                           "link a b loss -0.1",
                           "link a b delay 2 1",
                           "link a b rate 0",
                           "link a b lost never",
                           "link a b table 1",
                           "link a b table 2 1 0 1 0",
                           "link a b range -1",
                           "walls 0 0 0 1 1",
                           "walls 0 0 1 99999 99999",
                           "wall 0 0 1",
                           "link a b attempts 0"}) {
    EXPECT_THROW(networkOf({std::string(line)}), std::invalid_argument) << line;
  }
}

}  // namespace
}  // namespace move_base_abstract::radio
