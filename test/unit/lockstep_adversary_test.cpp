// Whatever the order in which bytes arrive, a run is the same, and it keeps to the rules; and each
// rule is missed when it is broken (test/mutants).
#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "broken.h"
#include "lockstep_client.h"
#include "lockstep_world.h"
#include "night.h"

namespace move_base_abstract::lockstep_adversary_test {
namespace {

const std::vector<ScriptNode> kPair{{"/a", 0, 1}, {"/b", 0, 1}};
const std::vector<ScriptNode> kThree{{"/a", 0, 1}, {"/robot_2", 0, 2}, {"/robot_10", 0, 2}};
const std::vector<ScriptNode> kFour{
    {"/coordinator", 0, 1}, {"/robot_2", 1, 2}, {"/robot_10", 1, 3}, {"/task", 2, 1}};
/** @brief The first ranks last: the order of names must not be the order of ranks everywhere. */
const std::vector<ScriptNode> kReversed{{"/a", 2, 1}, {"/b", 1, 2}, {"/c", -1, 1}};

WorldOptions busy(int grants) {
  WorldOptions options;
  options.grants = grants;
  options.pieces = true;
  options.leaving = true;
  return options;
}

// ---- every order of arrival
// ----------------------------------------------------------------------

struct Exhaustive {
  std::vector<ScriptNode> nodes;
  int grants;
  int most;  // runs by night
};

class EveryOrder : public testing::TestWithParam<Exhaustive> {};

TEST_P(EveryOrder, GivesTheSameRun) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    AllChoices all;
    std::string first;
    int runs = 0;
    do {
      WorldOptions options;
      options.grants = GetParam().grants;
      World world(GetParam().nodes, seed, options, all.choices());
      ASSERT_EQ(world.run(), "") << "seed " << seed << ", run " << runs;
      first = runs == 0 ? world.transcript() : first;
      ASSERT_EQ(world.transcript(), first) << "seed " << seed << ", run " << runs;
    } while (++runs < times(200, GetParam().most) && all.advance());
    EXPECT_GE(runs, 8);
    EXPECT_NE(first, "");
  }
}

INSTANTIATE_TEST_SUITE_P(Small, EveryOrder,
                         testing::Values(Exhaustive{kPair, 5, 2'000}, Exhaustive{kThree, 2, 2'000},
                                         Exhaustive{kReversed, 2, 2'000},
                                         Exhaustive{kFour, 1, 2'000}));

TEST(AnyOrder, OfBytesInPiecesGivesTheSameRun) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::string first;
    for (std::uint64_t order = 0; order < 10; ++order) {
      World world(kFour, seed, busy(25), randomChoices(order));
      ASSERT_EQ(world.run(), "") << "seed " << seed << ", order " << order;
      first = order == 0 ? world.transcript() : first;
      ASSERT_EQ(world.transcript(), first) << "seed " << seed << ", order " << order;
    }
    EXPECT_NE(first, "");
  }
}

TEST(AnyOrder, WithInputFromOutsideKeepsToTheRules) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    WorldOptions options = busy(15);
    options.knocks = true;
    World world(seed % 2 == 0 ? kFour : kReversed, seed, options, randomChoices(seed));
    ASSERT_EQ(world.run(), "") << "seed " << seed;
  }
}

TEST(AnyOrder, WithDeathsInTheMiddleOfAFrameKeepsToTheRules) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    WorldOptions options = busy(15);
    options.deaths = true;
    options.knocks = seed % 3 == 0;
    World world(kFour, seed, options, randomChoices(seed));
    ASSERT_EQ(world.run(), "") << "seed " << seed;
  }
}

// ---- what only a scenario shows
// --------------------------------------------------------------------

/** @return the names of checks that failed. */
using Checks = std::set<std::string>;

void check(Checks& failed, bool holds, const std::string& name) {
  if (!holds) {
    failed.insert(name);
  }
}

void zeroDelayLoop(Checks& failed) {
  LockstepSettings settings = named({"/a"});
  settings.max_microsteps = 20;
  Stage stage(settings);
  stage.join(1, "/a");
  int grants = 0;
  while (stage.grant(1) && grants < 100) {
    ++grants;
    stage.report(1, kSecond);
  }
  const std::string reason = stage.session.status().reason;
  check(failed, grants == 21 && stage.phase() == "zero_delay_loop", "zero-delay loop");
  check(failed, reason.find("'/a'") != std::string::npos && stage.said(reason), "zero-delay loop");
}

void replaced(Checks& failed) {
  Pair stage;
  stage.report(1, kNever, {advertise(1, "/x")});
  stage.join(3, "/b");  // a respawned one, while the old connection lives and owes its report
  const auto grant = stage.grant(3);
  check(failed, grant && grant->grant.microstep == 1, "replaced");
  check(failed, stage.closed[2] && stage.session.status().participants.size() == 2, "replaced");
}

/** @brief What /a had reported arrives, and nobody waits for it or for its answer. */
void lastWords(Checks& failed) {
  Pair stage;
  stage.report(1, 5 * kSecond, {advertise(1, "/x"), wire::Serve{1, 0, "/service"}});
  stage.report(2, 5 * kSecond, {subscribe(1, "/x"), wire::Call{0, 0, "/service", "request"}});
  stage.grant(1);
  stage.grant(2);
  stage.report(1, 5 * kSecond, {wire::Send{1, 0, 0, "last words"}});
  stage.cut(1);
  stage.report(2, 5 * kSecond);
  const auto grant = stage.grant(2);
  Checks got;
  for (const wire::GrantItem& item : grant ? grant->grant.items : std::vector<wire::GrantItem>()) {
    got.insert(itemText(item));
  }
  check(failed, got.count("deliver 1 1 last words") == 1, "last words");
  check(failed, got.count("answer 0 3") == 1, "cancelled call");
  check(failed, got.count("no publisher 1 1") == 1, "closed link");
}

void silence(Checks& failed) {
  Stage stage(named({"/a", "/b"}));
  stage.join(1, "/a");
  stage.join(2, "/b");
  stage.grant(1);
  stage.report(1, kNever);
  stage.wall = 11 * kSecond;
  stage.poll();
  check(failed, stage.said("'/b' has been silent for 11 s", LockstepMessage::Level::kWarn),
        "silence");
  check(failed, stage.said("the report of round 1"), "silence");
}

void deadlock(Checks& failed) {
  Stage stage(named({"/a"}));
  stage.join(1, "/a");
  stage.grant(1);
  stage.report(1, kNever, {wire::Note{wire::NoteKind::kWaitsFor, "a result"}}, 1);
  check(failed, stage.phase() == "deadlock", "deadlock");
  check(failed, stage.said("'/a' has 1 waiting thread (a result)", LockstepMessage::Level::kWarn),
        "deadlock");
}

/** @brief A thread that waits for work is idle, and no more so while a goal is open. */
void idleThreads(Checks& failed) {
  const std::string begin(12, '\0');  // of an action's messages: a header, its frame, a stamp
  const std::string goal = begin + std::string(12, '\0') + std::string("\1\0\0\0g", 5);
  Pair stage;
  stage.report(1, kNever,
               {wire::Idle{1}, wire::Advertise{1, 0, "/go/goal", "p/XActionGoal", "*", false, ""},
                wire::Subscribe{2, 0, "/go/result", "*"}});
  stage.report(2, kNever,
               {wire::Subscribe{1, 0, "/go/goal", "*"},
                wire::Advertise{2, 0, "/go/result", "p/XActionResult", "*", false, ""}});
  stage.grant(1);
  stage.grant(2);
  stage.report(1, kNever, {wire::Idle{1}});
  stage.report(2, kNever);
  check(failed, stage.phase() == "idle", "waiting for work");
  stage.frame(1, wire::Knock{});
  stage.grant(1);
  stage.report(1, kNever, {wire::Idle{1}, wire::Send{1, 0, 0, goal}});
  stage.grant(2);
  stage.report(2, kNever);
  check(failed, stage.phase() == "deadlock", "open goal");
  check(failed, stage.said("'/a' has 1 goal open on /go", LockstepMessage::Level::kWarn),
        "open goal");
  stage.frame(2, wire::Knock{});
  stage.grant(2);
  stage.report(2, kNever, {wire::Send{2, 0, 0, goal}});
  stage.grant(1);
  stage.report(1, kNever, {wire::Idle{1}});
  check(failed, stage.phase() == "idle", "waiting for work");
}

void gates(Checks& failed) {
  Stage stage(named({"/a"}));
  stage.session.pause();
  stage.join(1, "/a");
  stage.grant(1);
  stage.report(1, kSecond);
  check(failed, stage.point(1) == "1000+1", "the present while paused");
  stage.report(1, 2 * kSecond);
  check(failed, stage.point(1) == "none", "pause");
  stage.session.runUntil(3 * kSecond);
  stage.poll();
  stage.grant(1);
  stage.report(1, 4 * kSecond);
  check(failed, stage.session.now() == 3 * kSecond && stage.point(1) == "none", "target");
}

void limit(Checks& failed) {
  Stage stage(named({"/a"}));
  stage.session.setLimit(2.0);
  stage.join(1, "/a");
  stage.grant(1);
  stage.report(1, 2 * kSecond);
  check(failed, stage.point(1) == "none", "limit");
  stage.wall = kSecond / 2;
  stage.poll();
  check(failed, stage.point(1) == "2000+0", "limit is no pause");
}

Checks failedScenarios() {
  Checks failed;
  for (const auto& scenario :
       {zeroDelayLoop, replaced, lastWords, silence, deadlock, idleThreads, gates, limit}) {
    scenario(failed);
  }
  return failed;
}

// ---- every rule is worth its test
// ------------------------------------------------------------------

/** @return the names of all checks that fail, in runs of all kinds. */
Checks failedChecks() {
  Checks failed = failedScenarios();
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    WorldOptions options = busy(12);
    options.knocks = seed % 3 == 1;
    options.deaths = seed % 3 == 2;
    World world(seed % 4 == 3 ? kReversed : kFour, seed, options, randomChoices(seed));
    const std::string violation = world.run();
    if (!violation.empty()) {
      failed.insert(violation.substr(0, violation.find(':')));
    }
  }
  return failed;
}

struct RuleCase {
  const char* name;
  Checks expected;  // one of these has to fail
};

std::ostream& operator<<(std::ostream& out, const RuleCase& rule) { return out << rule.name; }

class RuleBroken : public testing::TestWithParam<RuleCase> {};

TEST_P(RuleBroken, IsNoticed) {
  const Broken broken(GetParam().name);
  const Checks failed = failedChecks();
  bool noticed = false;
  std::string all;
  for (const std::string& name : failed) {
    noticed = noticed || GetParam().expected.count(name) != 0;
    all += name + "; ";
  }
  EXPECT_TRUE(noticed) << "failed were: " << all;
}

TEST(NoRuleBroken, NothingIsViolated) { EXPECT_EQ(failedChecks(), Checks{}); }

INSTANTIATE_TEST_SUITE_P(
    Each, RuleBroken,
    testing::Values(
        RuleCase{"barrier", {"barrier"}}, RuleCase{"grant_only_concerned", {"extra grant"}},
        RuleCase{"deliver_before_leap", {"undelivered"}},
        RuleCase{"later_than_sent", {"microstep"}}, RuleCase{"leap_to_smallest", {"leap"}},
        RuleCase{"time_never_back", {"time back"}},
        RuleCase{"microstep_bound", {"zero-delay loop"}}, RuleCase{"sort_by_rank", {"mail order"}},
        RuleCase{"sort_by_sub", {"mail order"}}, RuleCase{"natural_order", {"mail order"}},
        RuleCase{"fifo_within_sender", {"mail order"}},
        RuleCase{"apply_in_order", {"mail", "mail order"}},
        RuleCase{"links_are_mail", {"missing grant", "undelivered"}},
        RuleCase{"replace", {"replaced"}},
        RuleCase{"calls_in_next_round", {"undelivered", "stall"}},
        RuleCase{"knock_counts", {"stall", "missing grant"}},
        RuleCase{"dead_not_awaited", {"stall"}}, RuleCase{"dead_delivers", {"last words"}},
        RuleCase{"dead_cancels_calls", {"cancelled call"}}, RuleCase{"silence_named", {"silence"}},
        RuleCase{"deadlock_named", {"deadlock"}},
        RuleCase{"work_is_not_owed", {"waiting for work"}},
        RuleCase{"goals_are_counted", {"open goal"}}, RuleCase{"gate_pause", {"pause"}},
        RuleCase{"gate_target", {"target"}}, RuleCase{"gate_limit", {"limit"}},
        RuleCase{"start_waits_for_named", {"start"}}),
    [](const auto& rule_case) { return std::string(rule_case.param.name); });

}  // namespace
}  // namespace move_base_abstract::lockstep_adversary_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
