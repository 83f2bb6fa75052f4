// Which cores a run is given: what is decided of given figures. No clock is looked at.
#include <gtest/gtest.h>

#include <functional>

#include "lockstep/core_choice.h"

namespace move_base_abstract::lockstep_core_choice_test {
namespace {

constexpr Nanoseconds kMicrosecond = 1000;
constexpr Nanoseconds kMillisecond = 1000 * kMicrosecond;
constexpr Nanoseconds kSecond = 1000 * kMillisecond;

/** @brief A machine on which a round takes what a function says of it. */
class Machine {
 public:
  using Cost = std::function<Nanoseconds(std::uint64_t round, std::size_t grants, bool one)>;

  explicit Machine(Cost cost, CoresWish wish = CoresWish::kAuto)
      : cost_(std::move(cost)), choice(wish) {}

  void become(Cost cost) { cost_ = std::move(cost); }

  void run(Nanoseconds duration) {
    for (const Nanoseconds end = wall + duration; wall < end; ++round) {
      const std::size_t grants = round % 5 == 0 ? 4 : 1;
      const bool one = choice.isOne();
      const Nanoseconds cost = cost_(round, grants, one);
      wall += cost;
      (one ? on_one : on_all) += cost;
      looking += choice.isLooking() ? cost : 0;
      choice.add(grants, cost, wall);
      if (choice.isOne() != one) {
        ++changes;
        wall += kMillisecond / 2;
        choice.addChange(kMillisecond / 2);
      }
    }
  }

 private:
  Cost cost_;

 public:
  CoreChoice choice;
  Nanoseconds wall = 0;
  Nanoseconds on_one = 0;
  Nanoseconds on_all = 0;
  Nanoseconds looking = 0;
  std::uint64_t round = 0;
  int changes = 0;
};

/** @brief Messages: waking the other core costs more than the work. */
Nanoseconds talk(std::uint64_t, std::size_t grants, bool one) {
  const auto size = static_cast<Nanoseconds>(grants);
  return (one ? 12 : 30) * kMicrosecond + size * 10 * kMicrosecond;
}

/** @brief Work: who is granted at once works beside the others. */
Nanoseconds work(std::uint64_t, std::size_t grants, bool one) {
  const auto size = static_cast<Nanoseconds>(grants);
  return 2 * kMillisecond * (one ? size : (size + 1) / 2);
}

Nanoseconds same(std::uint64_t, std::size_t, bool) { return 50 * kMicrosecond; }

TEST(CoreChoice, MessagesAreKeptOnOneCore) {
  Machine machine(talk);
  machine.run(kSecond / 2);
  EXPECT_TRUE(machine.choice.keepsOne());
  EXPECT_TRUE(machine.choice.isOne());
}

TEST(CoreChoice, WorkIsKeptOnAllCores) {
  Machine machine(work);
  machine.run(4 * kSecond);
  EXPECT_FALSE(machine.choice.isOne());
  EXPECT_LT(machine.on_one, machine.on_all / 4);
}

TEST(CoreChoice, WhatIsNoBetterChangesNothing) {
  Machine machine(same);
  machine.run(30 * kSecond);
  EXPECT_FALSE(machine.choice.keepsOne());
}

TEST(CoreChoice, LooksTakeASmallShareOfTheTime) {
  Machine machine(talk);
  machine.run(60 * kSecond);
  EXPECT_LT(machine.on_all, machine.wall / 50);
  EXPECT_LT(machine.looking, machine.wall / 20);
}

TEST(CoreChoice, AChangeOfTheWorkIsNoticed) {
  Machine machine(talk);
  machine.run(20 * kSecond);
  ASSERT_TRUE(machine.choice.keepsOne());
  machine.become(work);
  machine.run(4 * kSecond);
  EXPECT_FALSE(machine.choice.keepsOne());
  machine.become(talk);
  machine.run(20 * kSecond);
  EXPECT_TRUE(machine.choice.keepsOne());
}

TEST(CoreChoice, ARateOfEventsThatDiffersOverTheMissionDecidesNothing) {
  // Rounds of many take longer than those of one; in the spans on one core there are fewer of them.
  Machine machine([](std::uint64_t, std::size_t grants, bool) {
    return static_cast<Nanoseconds>(grants) * 100 * kMicrosecond;
  });
  for (int k = 0; k < 20'000; ++k) {
    const bool one = machine.choice.isOne();
    const std::size_t grants = k % (one ? 20 : 2) == 0 ? 4 : 1;
    const auto cost = static_cast<Nanoseconds>(grants) * 100 * kMicrosecond;
    machine.wall += cost;
    machine.choice.add(grants, cost, machine.wall);
    ASSERT_FALSE(machine.choice.keepsOne()) << k;
  }
}

TEST(CoreChoice, OneInterruptionDecidesNothing) {
  // Another process takes the cores for a second once, in a span on all of them.
  bool is_taken = false;
  Machine machine([&](std::uint64_t round, std::size_t grants, bool one) {
    const bool taken = !one && !is_taken && round > 60;
    is_taken = is_taken || taken;
    return work(round, grants, one) + (taken ? kSecond : 0);
  });
  machine.run(4 * kSecond);
  ASSERT_TRUE(is_taken);
  EXPECT_FALSE(machine.choice.keepsOne());
}

TEST(CoreChoice, SeldomWorkCountsByTheTimeThatItTakes) {
  // Most rounds are messages; one in 50 computes, and most of the time goes there.
  Machine machine([](std::uint64_t round, std::size_t grants, bool one) {
    return round % 50 == 0 ? (one ? 40 : 20) * kMillisecond : talk(round, grants, one);
  });
  machine.run(10 * kSecond);
  EXPECT_FALSE(machine.choice.keepsOne());
}

TEST(CoreChoice, WhatIsWishedIsKept) {
  Machine one(work, CoresWish::kOne);
  Machine all(talk, CoresWish::kAll);
  one.run(5 * kSecond);
  all.run(5 * kSecond);
  EXPECT_EQ(one.on_all, 0);
  EXPECT_EQ(all.on_one, 0);
}

TEST(CoreChoice, TestsMayHaveItAlternate) {
  Machine machine(same, CoresWish::kAlternate);
  machine.run(100 * 50 * kMicrosecond);
  EXPECT_GE(machine.changes, 4);
}

TEST(CoreChoice, DearerRoundsOnTheCoreThatIsKeptAskForAnotherOne) {
  Machine machine(talk);
  machine.run(5 * kSecond);
  ASSERT_TRUE(machine.choice.keepsOne());
  machine.become([](std::uint64_t round, std::size_t grants, bool one) {
    return talk(round, grants, one) * (one ? 4 : 1);  // somebody else works on this core
  });
  bool is_dearer = false;
  for (int k = 0; k < 20'000 && !is_dearer; ++k) {
    machine.run(kMicrosecond);
    is_dearer = machine.choice.isDearer();
  }
  EXPECT_TRUE(is_dearer);
  machine.run(5 * kSecond);
  EXPECT_FALSE(machine.choice.keepsOne());
}

}  // namespace
}  // namespace move_base_abstract::lockstep_core_choice_test
