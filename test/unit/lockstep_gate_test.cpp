// The gate of the event-driven clock: pause, step, run until, limit.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "clock/time_master.h"
#include "lockstep/rounds/rounds.h"
#include "lockstep_client.h"

namespace move_base_abstract::lockstep_gate_test {
namespace {

TEST(Gate, PauseFinishesTheInstantAndResumeGoesOn) {
  Alone alone(2 * kSecond);
  alone.grant(1);
  alone.session.pause();
  alone.report(1, 2 * kSecond);
  EXPECT_EQ(alone.point(1), "2000+1");
  alone.report(1, 3 * kSecond);
  EXPECT_EQ(alone.point(1), "none");
  EXPECT_EQ(alone.phase(), "paused");
  EXPECT_EQ(alone.session.now(), 2 * kSecond);
  alone.session.resume();
  EXPECT_LE(alone.session.nextWake(), alone.wall);  // there is something to decide
  alone.poll();
  EXPECT_EQ(alone.point(1), "3000+0");
}

TEST(Gate, StartPausedGrantsTheFirstInstantOnly) {
  LockstepSettings settings = named({"/a"});
  settings.start_paused = true;
  Stage stage(settings);
  stage.join(1, "/a");
  EXPECT_EQ(stage.point(1), "1000+0");
  stage.report(1, 2 * kSecond);
  EXPECT_EQ(stage.phase(), "paused");
}

TEST(Gate, TimeThatStandsForOthersIsNeitherIdleNorSetGoingByResume) {
  LockstepSettings settings = named({"/a"});
  settings.end_when_idle = true;
  Stage stage(settings);
  stage.session.holdForOthers("they are late");
  stage.join(1, "/a");
  stage.grant(1);
  EXPECT_FALSE(stage.session.wanted().has_value());  // the first instant is not over
  stage.report(1, kNever, {wire::Subscribe{0, 0, "/map", "m"}, wire::Watch{"/static_map"}});
  EXPECT_EQ(stage.phase(), "paused");
  ASSERT_TRUE(stage.session.wanted().has_value());
  EXPECT_TRUE(stage.session.wanted()->is_any);
  EXPECT_EQ(stage.session.wanted()->services, std::vector<std::string>{"/static_map"});
  stage.session.resume();
  stage.poll();
  EXPECT_EQ(stage.phase(), "paused");
  EXPECT_EQ(stage.session.status().reason, "they are late");
  stage.session.release("it has not come");
  stage.poll();
  EXPECT_EQ(stage.phase(), "ended");
  EXPECT_EQ(stage.session.status().not_repeatable, std::vector<std::string>{"it has not come"});
  EXPECT_FALSE(stage.session.wanted()->is_any);
}

TEST(Gate, RunUntilStopsAtExactlyItsTargetWithoutGrantingAnybody) {
  Alone alone(2 * kSecond);
  alone.grant(1);
  alone.session.runUntil(2'500'000'000);
  alone.report(1, 3 * kSecond);
  EXPECT_EQ(alone.point(1), "none");
  EXPECT_EQ(alone.session.now(), 2'500'000'000);
  EXPECT_EQ(alone.phase(), "paused");
  EXPECT_EQ(alone.session.status().run_until, std::nullopt);
  EXPECT_TRUE(alone.said("reached 2.5 s, paused"));
  alone.session.resume();
  alone.poll();
  EXPECT_EQ(alone.point(1), "3000+0");
}

TEST(Gate, RunUntilAWakeUpGrantsItAndFinishesThatInstant) {
  Alone alone(2 * kSecond);
  alone.grant(1);
  alone.session.runUntil(3 * kSecond);
  alone.report(1, 3 * kSecond);
  EXPECT_EQ(alone.point(1), "3000+0");
  alone.report(1, 3 * kSecond);
  EXPECT_EQ(alone.point(1), "3000+1");
  alone.report(1, 4 * kSecond);
  EXPECT_EQ(alone.phase(), "paused");
  EXPECT_EQ(alone.session.now(), 3 * kSecond);
}

TEST(Gate, ATargetIsReachedAlsoWhenEverybodyIsIdle) {
  Alone alone(kNever);
  alone.session.runUntil(2 * kSecond);
  alone.poll();
  EXPECT_EQ(alone.session.now(), 2 * kSecond);
  EXPECT_EQ(alone.phase(), "paused");
  alone.frame(1, wire::Knock{});
  EXPECT_EQ(alone.point(1), "2000+1");  // input from outside while it is paused
}

TEST(Gate, TheRunEndsAtItsEndWhateverElseTheGateIsTold) {
  LockstepSettings settings = named({"/a"});
  settings.end_at = 2.5;
  Alone alone(2 * kSecond, settings);
  alone.session.pause();
  alone.session.resume();
  alone.session.runUntil(100 * kSecond);
  alone.grant(1);
  alone.session.step(50 * kSecond);
  alone.report(1, 3 * kSecond);
  EXPECT_EQ(alone.phase(), "ended");
  EXPECT_EQ(alone.session.now(), 2'500'000'000);
  EXPECT_EQ(alone.end[1], "the run was to end at 2.5 s");
  EXPECT_EQ(alone.session.status().ended_by, "end_at");
  EXPECT_TRUE(alone.session.status().ended_as_wished);
}

TEST(Gate, AnIdleRunWithAnEndEndsAsWishedWhenItIsIdle) {
  LockstepSettings settings = named({"/a"});
  settings.end_at = 2.5;
  settings.end_when_idle = true;
  Alone alone(2 * kSecond, settings);
  alone.grant(1);
  alone.report(1, kNever);
  EXPECT_EQ(alone.phase(), "ended");
  EXPECT_TRUE(alone.session.status().ended_as_wished);
  EXPECT_EQ(alone.session.now(), 2 * kSecond);
  EXPECT_EQ(alone.end[1].substr(0, 11), "idle at 2 s");
  EXPECT_EQ(alone.session.status().ended_by, "idle");
}

TEST(Gate, AnEndFromOutsideCutsTheRunUnlessItWouldStandThereInEachRun) {
  {
    Alone moving(2 * kSecond);
    moving.session.endFromOutside("SIGTERM");
    EXPECT_TRUE(moving.session.status().cut);
  }
  {
    Alone idle(kNever);
    idle.session.endFromOutside("SIGTERM");
    EXPECT_FALSE(idle.session.status().cut);
  }
  {
    Stage before_the_start(named({"/a", "/b"}));
    before_the_start.join(1, "/a");
    before_the_start.session.endFromOutside("SIGTERM");
    EXPECT_TRUE(before_the_start.session.status().cut);
  }
  for (const bool by_hand : {false, true}) {
    Alone paused(2 * kSecond);
    paused.grant(1);
    paused.session.runUntil(2'500'000'000);
    paused.report(1, 3 * kSecond);
    if (by_hand) {
      paused.session.pause();
    }
    EXPECT_EQ(paused.phase(), "paused");
    paused.session.endFromOutside("SIGTERM");
    EXPECT_EQ(paused.session.status().cut, by_hand);
  }
}

TEST(Gate, AnEndBeforeTheStartIsRefused) {
  LockstepSettings settings = named({"/a"});
  settings.end_at = 0.5;
  EXPECT_THROW(Stage stage(settings), std::invalid_argument);
}

TEST(Gate, StepsAddUpFromTheTargetOfOneThatIsUnderWay) {
  Alone alone(2 * kSecond);
  EXPECT_EQ(alone.session.step(5 * kSecond), 6 * kSecond + 1 * kSecond);
  EXPECT_EQ(alone.session.step(kSecond), 8 * kSecond);
  alone.grant(1);
  alone.report(1, kNever);
  EXPECT_EQ(alone.session.now(), 8 * kSecond);
  EXPECT_EQ(alone.session.step(kSecond), 9 * kSecond);
}

TEST(Gate, RefusalsSayWhatIsAllowedAndChangeNothing) {
  Alone alone(kNever);
  EXPECT_EQ(refusal([&] { alone.session.step(0); }),
            "step: duration must be more than 0 and at most 2147483646 s from 1 s on, got 0 s");
  EXPECT_EQ(refusal([&] { alone.session.runUntil(kSecond - 1); }),
            "run_until: target must be from the present, 1 s, to 2147483647 s, got 0.999999999 s");
  EXPECT_NE(refusal([&] { alone.session.setLimit(1e7); }).find("got 10000000"), std::string::npos);
  EXPECT_FALSE(alone.session.status().paused);
  EXPECT_EQ(alone.session.status().run_until, std::nullopt);
  alone.session.endFromOutside("enough");
  EXPECT_EQ(refusal([&] { alone.session.resume(); }), "resume: the run has ended, at 1 s");
}

TEST(Gate, ALimitIsNeverExceededAndNothingIsCaughtUp) {
  LockstepSettings settings = named({"/a"});
  settings.limit = 10.0;
  Alone alone(2 * kSecond, settings);
  EXPECT_EQ(alone.phase(), "limited");
  EXPECT_EQ(alone.session.nextWake(), kSecond / 10);
  alone.wall = kSecond / 10 - 1;
  alone.poll();
  EXPECT_EQ(alone.point(1), "none");
  alone.wall = 5 * kSecond;  // somebody polls late
  alone.poll();
  EXPECT_EQ(alone.point(1), "2000+0");
  alone.report(1, 2'000'000'001);
  EXPECT_EQ(alone.session.nextWake(), 5 * kSecond + 1);  // 0.1 ns, rounded up
  alone.wall += 1;
  alone.poll();
  EXPECT_TRUE(alone.grant(1));
  alone.report(1, 12'000'000'001);
  EXPECT_EQ(alone.session.nextWake(), 6 * kSecond + 1);
  alone.session.setLimit(0.0);
  alone.poll();
  EXPECT_TRUE(alone.grant(1));
}

TEST(Gate, ALimitHoldsForTheWayToATargetToo) {
  LockstepSettings settings = named({"/a"});
  settings.limit = 1.0;
  Alone alone(kNever, settings);
  alone.session.runUntil(3 * kSecond);
  alone.poll();
  EXPECT_EQ(alone.session.now(), kSecond);
  EXPECT_EQ(alone.session.nextWake(), 2 * kSecond);
  alone.wall = 2 * kSecond;
  alone.poll();
  EXPECT_EQ(alone.session.now(), 3 * kSecond);
  EXPECT_EQ(alone.phase(), "paused");
}

}  // namespace
}  // namespace move_base_abstract::lockstep_gate_test
