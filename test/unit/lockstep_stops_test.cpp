// Stops for a debugger: after which round, and that nothing changes, however long a run stands.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "lockstep_client.h"
#include "lockstep_walkers.h"
#include "lockstep_world.h"

namespace move_base_abstract::lockstep_stops_test {
namespace {

constexpr Nanoseconds kHour = 3600 * kSecond;

StopCondition rounds(std::uint64_t count = 1) {
  StopCondition condition;
  condition.count = count;
  return condition;
}

StopCondition rows(const std::string& kind, const std::string& robot = "",
                   const std::string& topic = "", std::uint64_t count = 1) {
  StopCondition condition;
  condition.what = StopCondition::What::kRow;
  condition.kind = kind;
  condition.robot = robot;
  condition.topic = topic;
  condition.count = count;
  return condition;
}

StopCondition rowNumber(std::uint64_t row) {
  StopCondition condition = rows("");
  condition.row = row;
  return condition;
}

wire::Log log(const char* robot, const char* kind) { return {0, robot, kind, "[]"}; }

TEST(Stops, ARoundIsTheLastOneAndTheNextOneOfTheInstantStandsToo) {
  Pair pair;
  EXPECT_EQ(pair.session.stopWhen(rounds()), 1U);
  pair.report(1, kSecond);  // once more at this instant
  EXPECT_EQ(pair.phase(), "running");
  pair.report(2, 3 * kSecond);
  EXPECT_EQ(pair.phase(), "stopped");
  EXPECT_EQ(pair.point(1), "none");
  const LockstepStatus status = pair.session.status();
  EXPECT_TRUE(status.paused);
  EXPECT_EQ(status.stops, 1U);
  EXPECT_EQ(status.stop_row, 0U);
  EXPECT_EQ(status.reason, "stopped at 1 s after round 1");
  pair.session.stopWhen(rounds());
  pair.poll();
  EXPECT_EQ(pair.point(1), "1000+1");
  pair.report(1, 2 * kSecond);
  EXPECT_EQ(pair.phase(), "stopped");
  EXPECT_EQ(pair.session.status().reason, "stopped at 1 s after round 2");
  pair.session.resume();
  pair.poll();
  EXPECT_EQ(pair.phase(), "running");
  EXPECT_EQ(pair.point(1), "2000+0");
}

TEST(Stops, AnyOtherCallLeavesTheStop) {
  for (const std::string call : {"pause", "step", "run_until"}) {
    Alone alone(2 * kSecond);
    alone.session.stopWhen(rounds());
    alone.grant(1);
    alone.report(1, 2 * kSecond);
    ASSERT_EQ(alone.phase(), "stopped");
    call == "pause"  ? alone.session.pause()
    : call == "step" ? static_cast<void>(alone.session.step(kSecond))
                     : alone.session.runUntil(3 * kSecond);
    alone.poll();
    EXPECT_EQ(alone.point(1), "2000+1") << call;
    alone.report(1, 4 * kSecond);
    EXPECT_EQ(alone.phase(), "paused") << call;
    EXPECT_EQ(alone.session.now(), call == "pause" ? 2 * kSecond : 3 * kSecond) << call;
  }
}

TEST(Stops, APauseInBetweenGivesTheStopUp) {
  Alone alone(2 * kSecond);
  alone.session.stopWhen(rounds(2));
  alone.session.resume();
  for (int second = 2; second < 6; ++second) {
    ASSERT_TRUE(alone.grant(1));
    alone.report(1, (second + 1) * kSecond);
  }
  EXPECT_EQ(alone.phase(), "running");
}

TEST(Stops, TheNthMatchingRowStopsTheRunAfterItsRound) {
  Pair pair;
  pair.session.stopWhen(rows("result", "robot_1", "", 2));
  pair.report(1, 2 * kSecond, {log("robot_1", "result"), log("robot_2", "result")});
  pair.report(2, 2 * kSecond, {log("robot_1", "goal")});
  ASSERT_EQ(pair.point(1), "2000+0");
  ASSERT_EQ(pair.point(2), "2000+0");
  pair.report(1, 3 * kSecond, {log("", "other"), log("robot_1", "result"), log("", "other")});
  pair.report(2, 3 * kSecond);
  EXPECT_EQ(pair.phase(), "stopped");
  EXPECT_EQ(pair.session.status().stop_row, 5U);
  EXPECT_EQ(pair.session.status().rows, 6U);
  EXPECT_EQ(pair.session.status().reason,
            "stopped at 2 s after round 2, at row 5: result of robot_1");
}

TEST(Stops, ARowByItsNumberStopsTheRunThereAlsoBeforeTheStart) {
  LockstepSettings settings = named({"/a"});
  settings.start_stopped = true;
  Stage stage(settings);
  EXPECT_EQ(stage.phase(), "waiting_for_participants");
  stage.join(1, "/a");
  EXPECT_EQ(stage.phase(), "stopped");
  EXPECT_EQ(stage.session.status().reason, "stopped before the first round");
  stage.wall += kHour;
  stage.poll();
  EXPECT_EQ(stage.point(1), "none");
  EXPECT_FALSE(stage.said("does not start"));
  stage.session.stopWhen(rowNumber(2));
  stage.poll();
  EXPECT_EQ(stage.point(1), "1000+0");
  stage.report(1, 2 * kSecond, {log("", "one")});
  EXPECT_EQ(stage.point(1), "2000+0");
  stage.report(1, 3 * kSecond, {log("", "two"), log("", "three")});
  EXPECT_EQ(stage.phase(), "stopped");
  EXPECT_EQ(stage.session.status().stop_row, 2U);
  EXPECT_EQ(refusal([&] { stage.session.stopWhen(rowNumber(3)); }),
            "stop_when: row must be more than the rows that the log has, 3, got 3");
  EXPECT_EQ(stage.phase(), "stopped");
}

TEST(Stops, AMessageStopsTheRunAlsoIfTheLogHasNone) {
  for (const bool is_logged : {false, true}) {
    LockstepSettings settings = named({"/a", "/b"});
    settings.log_messages = is_logged;
    Pair pair(settings);
    pair.report(1, 2 * kSecond, {advertise(1, "/t"), advertise(2, "/other")});
    pair.report(2, kNever, {subscribe(1, "/t"), subscribe(2, "/other")});
    pair.session.stopWhen(rows("message", "", "/t"));
    pair.grant(1);
    pair.grant(2);
    pair.report(1, 2 * kSecond);
    pair.report(2, kNever);
    ASSERT_EQ(pair.point(1), "2000+0");
    pair.report(1, 3 * kSecond, {wire::Send{2, 0, 0, "no"}});
    ASSERT_EQ(pair.point(2), "2000+1");
    pair.report(2, kNever);
    ASSERT_EQ(pair.point(1), "3000+0");
    pair.report(1, 4 * kSecond, {wire::Send{1, 0, 0, "yes"}});
    EXPECT_EQ(pair.phase(), "stopped");
    EXPECT_EQ(pair.session.status().reason,
              "stopped at 3 s after round 5: a message of '/a' on /t");
    EXPECT_EQ(lines(pair.session).size(), is_logged ? 2U : 0U);
    EXPECT_EQ(pair.point(2), "none");
  }
}

TEST(Stops, AnInstantOrTheEndOfTheRunMayComeFirst) {
  LockstepSettings settings = named({"/a"});
  settings.end_at = 4.0;
  Alone alone(2 * kSecond, settings);
  StopCondition condition = rows("never");
  condition.until = 3 * kSecond;
  alone.session.stopWhen(condition);
  alone.grant(1);
  alone.report(1, 5 * kSecond);
  EXPECT_EQ(alone.phase(), "paused");
  EXPECT_EQ(alone.session.now(), 3 * kSecond);
  condition.until = 0;
  alone.session.stopWhen(condition);
  alone.poll();
  EXPECT_EQ(alone.end[1], "the run was to end at 4 s");
  EXPECT_EQ(refusal([&] { alone.session.stopWhen(rounds()); }),
            "stop_when: the run has ended, at 4 s");
}

TEST(Stops, WhatCannotBeIsRefusedAndChangesNothing) {
  Alone alone(2 * kSecond);
  StopCondition round = rounds();
  round.topic = "/t";
  StopCondition row = rowNumber(3);
  row.kind = "result";
  for (const auto& [condition, text] : std::vector<std::pair<StopCondition, std::string>>{
           {round, "stop_when: with ROUND, kind, robot and topic must be ''"},
           {row, "stop_when: with a row, kind, robot and topic must be ''"},
           {rows("", "robot", "/t"), "stop_when: topic and robot must not be given both"}}) {
    EXPECT_EQ(
        refusal([&, &one = condition] { alone.session.stopWhen(one); }).substr(0, text.size()),
        text);
  }
  alone.grant(1);
  alone.report(1, 3 * kSecond);
  EXPECT_EQ(alone.point(1), "3000+0");
}

// ---- limits of wall time stand ---------------------------------------------------------------

struct Stopped : Pair {
  explicit Stopped(LockstepSettings settings = named({"/a", "/b"})) : Pair(std::move(settings)) {
    session.stopWhen(rounds());
    report(1, 2 * kSecond);
    report(2, 2 * kSecond);
    EXPECT_EQ(phase(), "stopped");
  }

  void stand(Nanoseconds duration) {
    wall += duration;
    poll();
  }

  void goOn() {
    session.resume();
    poll();
  }
};

TEST(Limits, OfReportsAndOfSpeedAreMovedByAStop) {
  LockstepSettings settings = named({"/a", "/b"});
  settings.limit = 1.0;
  Stopped run(settings);
  EXPECT_EQ(run.session.nextWake(), kNever);
  run.wall += kHour;  // nobody polls
  run.goOn();
  EXPECT_EQ(run.phase(), "limited");  // a whole second is left
  EXPECT_EQ(run.session.nextWake(), kHour + kSecond);
  run.stand(kSecond);
  EXPECT_EQ(run.point(1), "2000+0");
  EXPECT_EQ(run.session.nextWake(), kHour + 11 * kSecond);
  run.stand(10 * kSecond - 1);
  EXPECT_FALSE(run.said("silent"));
  run.stand(1);
  EXPECT_TRUE(run.said("'/a' has been silent for 10 s of wall time"));
}

TEST(Limits, OfAnEndThatASignalAskedForAreMovedByAStop) {
  Stopped run;
  run.frame(1, wire::Stopping{"SIGINT"});
  run.cut(1);
  run.stand(kHour);
  EXPECT_EQ(run.phase(), "stopped");
  run.goOn();
  EXPECT_EQ(run.point(2), "none");
  run.stand(Interruption::kGrace - 1);
  EXPECT_EQ(run.point(2), "none");
  run.stand(1);
  EXPECT_EQ(run.point(2), "2000+0");
  EXPECT_EQ(run.session.status().not_repeatable.size(), 1U);
}

TEST(Limits, OfHelloAreMovedByAStop) {
  Stopped run;
  run.session.connect(7, run.wall);
  run.stand(kHour);
  EXPECT_FALSE(run.closed[7]);
  run.goOn();
  run.stand(Connections::kHelloLimit - 1);
  EXPECT_FALSE(run.closed[7]);
  run.stand(1);
  EXPECT_TRUE(run.closed[7]);
}

TEST(Limits, StandWhileSomebodyLooksAtANodeThatWorks) {
  Pair pair;
  pair.session.look("/a", true);
  pair.poll();
  pair.wall += kHour;
  pair.poll();
  EXPECT_EQ(pair.phase(), "running");
  EXPECT_FALSE(pair.said("silent"));
  EXPECT_EQ(pair.session.status().looked_at, std::vector<std::string>{"/a"});
  pair.report(1, 2 * kSecond);  // the other one works on, and its time counts again
  pair.wall += 10 * kSecond;
  pair.poll();
  EXPECT_TRUE(pair.said("'/b' has been silent for 10 s"));
  pair.session.look("/a", false);
  EXPECT_EQ(refusal([&] { pair.session.look("/a", false); }), "looking: nobody looks at '/a'");
  EXPECT_EQ(refusal([&] { pair.session.look("/c", true); }),
            "looking: node must be a participant, got '/c'; there are: /a, /b");
}

TEST(Limits, StandWhileANodeSaysThatItIsLookedAt) {
  Pair pair;
  pair.frame(1, wire::Looked{true});
  pair.wall += kHour;
  pair.poll();
  EXPECT_FALSE(pair.said("silent"));
  pair.frame(1, wire::Looked{false});
  pair.frame(1, wire::Looked{false});
  pair.wall += 10 * kSecond;
  pair.poll();
  EXPECT_TRUE(pair.said("'/a' has been silent for 10 s"));
}

TEST(Limits, StandNoMoreWhenTheNodeHasGone) {
  Pair pair;
  pair.session.look("/a", true);
  pair.cut(1);
  pair.report(2, 2 * kSecond);
  EXPECT_TRUE(pair.session.status().looked_at.empty());
}

// ---- whatever comes meanwhile ----------------------------------------------------------------

TEST(Stops, OnlookersAreNotCountedInTheMiddleOfTheFirstInstant) {
  Stopped run;
  EXPECT_FALSE(run.session.wanted().has_value());
  run.goOn();
}

TEST(Stops, TheEndOfAllParticipantsIsTheEndOfTheRun) {
  LockstepSettings settings = named({"/a", "/b"});
  settings.end_when_idle = true;
  Stopped run(settings);
  for (const ConnectionId id : {1, 2}) {
    run.frame(id, wire::Stopping{"SIGINT"});
    run.cut(id);
  }
  EXPECT_EQ(run.phase(), "ended");
  EXPECT_TRUE(run.session.status().cut);
  EXPECT_TRUE(run.session.status().not_repeatable.empty());
}

TEST(Stops, AnEndFromOutsideCutsTheRun) {
  Stopped run;
  run.session.endFromOutside("enough");
  run.poll();
  EXPECT_EQ(run.end[1], "enough");
  EXPECT_TRUE(run.session.status().cut);
}

TEST(Stops, WhatComesWhileTheRunStandsCountsWhenItGoesOn) {
  Stopped run;
  run.frame(1, wire::Knock{});
  run.stand(kSecond);
  EXPECT_EQ(run.point(1), "none");
  run.goOn();
  EXPECT_EQ(run.point(1), "1000+1");
  EXPECT_EQ(run.point(2), "none");
}

// ---- stopping changes nothing ----------------------------------------------------------------

TEST(Stops, AtAnyRoundsChangeNothing) {
  const std::vector<ScriptNode> nodes{
      {"/coordinator", 0, 1}, {"/robot_2", 1, 2}, {"/robot_10", 1, 3}, {"/task", 2, 1}};
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::string plain;
    for (std::uint64_t order = 0; order < 6; ++order) {
      WorldOptions options;
      options.grants = 25;
      options.pieces = options.leaving = true;
      options.stops = order != 0;
      World world(nodes, seed, options, randomChoices(order));
      ASSERT_EQ(world.run(), "") << "seed " << seed << ", order " << order;
      plain = order == 0 ? world.transcript() : plain;
      ASSERT_EQ(world.transcript(), plain) << "seed " << seed << ", order " << order;
      ASSERT_TRUE(order == 0 || world.stops() > 3) << world.stops();
    }
  }
}

TEST(Stops, AtAnyWindowsChangeNothing) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const std::vector<Actor> actors = randomActors(seed);
    const std::vector<std::string> plain = Walkers(actors, seed).run();
    Walkers walkers(actors, seed + 1000);
    walkers.may_stop = true;
    ASSERT_EQ(walkers.run(), plain) << seed;
    ASSERT_GT(walkers.session.status().stops, 2U) << seed;
  }
}

}  // namespace
}  // namespace move_base_abstract::lockstep_stops_test
