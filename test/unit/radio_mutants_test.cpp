// The radio's formulas, draws and order: each rule is missed when it is broken (test/mutants).
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "broken.h"
#include "lockstep/radio/draws.h"
#include "lockstep/radio/link_watch.h"
#include "lockstep/radio/radio.h"
#include "radio_motion.h"

namespace move_base_abstract::radio {
namespace {

using Checks = std::set<std::string>;
using Kind = Radio::Outcome::Kind;

void check(Checks& failed, bool holds, const char* name) {
  if (!holds) {
    failed.insert(name);
  }
}

/** @brief Two hosts on a line, 8 m apart, and a link that is as @p keys say. */
struct Line {
  explicit Line(const std::string& keys, const std::string& place = "at 8.5 0.5")
      : radio(networkOf({"host a at 0.5 0.5 /a", "host b " + place + " /b", "walls 0 0 1 20 1",
                         "wall 0 5 6", "link a b " + keys})),
        a(radio.hosts().of("/a")),
        b(radio.hosts().of("/b")) {}
  Radio::Outcome send(std::size_t bytes, Nanoseconds now) {
    return radio.send(a, b, bytes, ++ticket, now);
  }
  /** @return the tickets of what arrives of @p count messages, one each @p gap ns, and when. */
  std::vector<std::pair<Nanoseconds, Ticket>> all(int count, Nanoseconds gap) {
    std::vector<std::pair<Nanoseconds, Ticket>> arrived;
    const auto take = [&](const Radio::Outcome& outcome, Ticket of) {
      if (outcome.kind == Kind::kArrives) {
        arrived.emplace_back(outcome.at, of);
      }
    };
    const auto lookUntil = [&](Nanoseconds until) {
      for (Nanoseconds due = radio.nextLook(); due < until; due = radio.nextLook()) {
        for (const Radio::Decided& one : radio.look(due)) {
          take(one.outcome, one.ticket);
        }
      }
    };
    for (int k = 0; k < count; ++k) {
      lookUntil(k * gap);
      take(send(1, k * gap), ticket);
    }
    lookUntil(kNever);
    return arrived;
  }
  Radio radio;
  HostId a, b;
  Ticket ticket = 0;
};

bool isNear(std::size_t count, double expected, double variance) {
  const double off = static_cast<double>(count) - expected;
  return off * off < 25.0 * variance;  // five standard deviations
}

void chance(Checks& failed) {
  check(failed, isNear(Line("loss 0.3").all(20'000, 1).size(), 14'000, 4'200), "loss");
  const auto thrice = Line("loss 0.5 lost retry retry 1000 attempts 3").all(4'000, 10'000);
  check(failed, isNear(thrice.size(), 3'500, 437.5), "attempts");
  check(failed, linkKey(1, "a", "b") != linkKey(1, "b", "a"), "directions");
  check(failed, Line("delay 0 1000").send(1, 0).at <= 1000, "delay");
}

void order(Checks& failed) {
  const auto arrived = Line("delay 0 1000").all(500, 10);
  for (std::size_t k = 1; k < arrived.size(); ++k) {
    check(failed, arrived[k - 1].first <= arrived[k].first, "overtaken");
  }
  const auto retried = Line("loss 0.4 lost retry retry 1000").all(500, 10);
  for (std::size_t k = 1; k < retried.size(); ++k) {
    check(failed, retried[k - 1].second < retried[k].second, "overtaken");
  }
}

void rate(Checks& failed) {
  check(failed, Line("rate 3000000000").send(1, 0).at == 3, "rate");
  check(failed, Line("delay 5 5 rate 1000000000").send(1, 0).at == 13, "delay");
  Line full("rate 8 buffer 10");
  check(failed, full.send(10, 0).kind == Kind::kArrives, "buffer");
  check(failed, full.send(1, 0).kind == Kind::kLost, "buffer");
  Line again("loss 1 lost retry retry 1000 attempts 3");
  again.send(1, 0);
  check(failed, again.radio.nextLook() == 1000, "back-off");
  again.radio.look(1000);
  check(failed, again.radio.nextLook() == 3000, "back-off");
}

void places(Checks& failed) {
  check(failed, Line("range 8").send(1, 0).kind == Kind::kArrives, "range");
  check(failed, Line("range 7.9").send(1, 0).kind == Kind::kLost, "range");
  check(failed, Line("range 10 wall 3").send(1, 0).kind == Kind::kLost, "walls");
  Line drive("range 5.01", "robot");
  drive.radio.hosts().move(
      "b", motion::Motion(piece(0, 10.5, -2) + piece(5 * kNanosecondsPerSecond, 0.5, 0)));
  LinkWatch watch(drive.radio.hosts());
  watch.meet(0);
  watch.take();
  watch.advance(5 * kNanosecondsPerSecond);
  const auto changes = watch.take();
  check(failed, changes.size() == 1, "link");
  const auto isUp = [&drive](Nanoseconds at) {
    return drive.radio.hosts().reach(*drive.radio.hosts().rule(1, 2), 1, 2, at).is_up;
  };
  check(failed, isUp(changes[0].at) && !isUp(changes[0].at - 1), "link");
}

void formulas(Checks& failed) {
  check(failed, lossAt(LossTable{{0.0, 0.0}, {10.0, 1.0}}, 5.0, 0.0) == 0.5, "table");
  PathLoss law{20.0, -81.0, 3.0, 1.0, 40.0, 0.0};
  check(failed, lossAt(law, 100.0, 0.0) == 0.0 && lossAt(law, 110.0, 0.0) == 1.0, "path loss");
  law.shadowing = 10.0;
  check(failed, lossAt(law, 10.0, 0.0) < 0.01 && lossAt(law, 1000.0, 0.0) > 0.99, "shadowing");
}

Checks failedChecks() {
  Checks failed;
  for (const auto& scenario : {chance, order, rate, places, formulas}) {
    scenario(failed);
  }
  return failed;
}

struct RuleCase {
  const char* name;
  const char* expected;  // has to fail
};

std::ostream& operator<<(std::ostream& out, const RuleCase& rule) { return out << rule.name; }

class RadioRuleBroken : public testing::TestWithParam<RuleCase> {};

TEST_P(RadioRuleBroken, IsNoticed) {
  const Broken broken(GetParam().name);
  EXPECT_EQ(failedChecks().count(GetParam().expected), 1U);
}

TEST(NoRadioRuleBroken, NothingIsViolated) { EXPECT_EQ(failedChecks(), Checks{}); }

INSTANTIATE_TEST_SUITE_P(
    Each, RadioRuleBroken,
    testing::Values(
        RuleCase{"radio_loss", "loss"}, RuleCase{"radio_draws_by_message", "loss"},
        RuleCase{"radio_draws_by_attempt", "attempts"},
        RuleCase{"radio_draws_by_direction", "directions"},
        RuleCase{"radio_delay_after_sending", "delay"},
        RuleCase{"radio_nothing_overtakes", "overtaken"},
        RuleCase{"radio_those_behind_wait", "overtaken"}, RuleCase{"radio_rounds_up", "rate"},
        RuleCase{"radio_backs_off", "back-off"}, RuleCase{"radio_buffer", "buffer"},
        RuleCase{"radio_range_itself_hears", "range"}, RuleCase{"radio_walls_cost", "walls"},
        RuleCase{"radio_table_is_straight", "table"}, RuleCase{"radio_path_loss", "path loss"},
        RuleCase{"radio_shadowing", "shadowing"}, RuleCase{"radio_link_to_the_nanosecond", "link"}),
    [](const testing::TestParamInfo<RuleCase>& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace move_base_abstract::radio
