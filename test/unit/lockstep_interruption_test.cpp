// Participants that are told to end: when that says something of the run, and when it does not.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "lockstep_client.h"

namespace move_base_abstract::lockstep_interruption_test {
namespace {

using Texts = std::vector<std::string>;

constexpr Nanoseconds kLong = Interruption::kPatience + 1;

/** @brief Three that move on every second, of which the third is not named in any test below. */
struct Three : Stage {
  explicit Three(LockstepSettings settings = named({"/a", "/b", "/c"})) : Stage(settings) {
    for (const ConnectionId id : {1, 2, 3}) {
      join(id, id == 1 ? "/a" : id == 2 ? "/b" : "/c");
    }
    for (const ConnectionId id : {1, 2, 3}) {
      grant(id);
      report(id, 2 * kSecond, {wire::Log{0, "robot", "first", "[]"}});
    }
    for (const ConnectionId id : {1, 2, 3}) {
      grant(id);
    }
    lines(session);
  }

  void stop(ConnectionId id) { frame(id, wire::Stopping{"SIGINT"}); }
  void leaveNow(ConnectionId id) { frame(id, wire::Leave{"SIGINT"}); }

  void pass(Nanoseconds duration) {
    wall += duration;
    poll();
  }

  Texts labels() {
    Texts all = session.status().not_repeatable;
    for (const std::string& text : session.status().degraded) {
      all.push_back(text);
    }
    return all;
  }
};

TEST(Interruption, OfAllInAnyOrderSaysNothingOfTheRunAndAddsNothingToItsLog) {
  for (const auto& order :
       std::vector<std::vector<ConnectionId>>{{1, 2, 3}, {3, 2, 1}, {2, 3, 1}}) {
    Three three;
    three.report(order[0], 3 * kSecond, {wire::Log{0, "robot", "half a round", "[]"}});
    for (const ConnectionId id : order) {
      three.stop(id);
      three.pass(kSecond / 10);
      three.leaveNow(id);
      three.pass(kSecond / 10);
      three.cut(id);
    }
    EXPECT_EQ(three.labels(), Texts{});
    EXPECT_EQ(lines(three.session), Texts{});
    EXPECT_EQ(three.phase(), "idle");
    EXPECT_TRUE(three.session.status().cut);
  }
}

TEST(Interruption, OfAllWhoHaveNothingLeftToDoCutsNothing) {
  Three three;
  for (const ConnectionId id : {1, 2, 3}) {
    three.report(id, kNever);
  }
  for (const ConnectionId id : {1, 2, 3}) {
    three.stop(id);
    three.leaveNow(id);
  }
  EXPECT_EQ(three.labels(), Texts{});
  EXPECT_FALSE(three.session.status().cut);
}

TEST(Interruption, OfAllDoesNotLogTheCallsThatItCutsShort) {
  LockstepSettings settings = named({"/a", "/b", "/c"});
  settings.log_messages = true;
  Three three(settings);
  three.report(1, 3 * kSecond, {wire::Serve{1, 0, "/s"}});
  three.report(2, 3 * kSecond, {wire::Call{0, 0, "/s", ""}});
  three.report(3, 3 * kSecond);
  three.grant(1);
  EXPECT_EQ(lines(three.session).size(), 1U);
  for (const ConnectionId id : {1, 2, 3}) {
    three.stop(id);
  }
  EXPECT_EQ(lines(three.session), Texts{});
}

TEST(Interruption, OfAllWhoseConnectionsAreLostSaysNothingEither) {
  Three three;
  for (const ConnectionId id : {1, 2, 3}) {
    three.stop(id);
    three.cut(id);
  }
  EXPECT_EQ(three.labels(), Texts{});
}

TEST(Interruption, OfAllEndsThoseWhoWaitForTheirLastWords) {
  Three three;
  three.stop(1);
  three.frame(1, wire::Knock{});
  three.stop(2);
  EXPECT_FALSE(three.closed[1]);
  three.stop(3);
  EXPECT_TRUE(three.closed[1] && three.closed[2] && three.closed[3]);
  EXPECT_EQ(three.labels(), Texts{});
}

TEST(Interruption, OfTheTimeMasterLastOrInBetweenSaysNothingOfTheRun) {
  Three three;
  three.stop(1);
  three.leaveNow(1);
  three.pass(kSecond);
  three.session.endFromOutside("the time master was told to end");
  three.poll();
  EXPECT_EQ(three.labels(), Texts{});
  EXPECT_EQ(lines(three.session), Texts{});
  EXPECT_EQ(three.end[2], "the time master was told to end");
}

TEST(Interruption, OfOneIsSaidWhenTheOthersStayAndTimeStandsUntilThen) {
  Three three;
  three.stop(1);
  three.leaveNow(1);
  three.report(2, 3 * kSecond, {wire::Log{0, "robot", "second", "[]"}});
  three.report(3, 3 * kSecond);
  three.cut(1);
  three.pass(Interruption::kGrace - 1);
  EXPECT_EQ(three.point(2), "none");
  EXPECT_EQ(three.labels(), Texts{});
  EXPECT_EQ(three.session.nextWake(), three.wall + 1);
  three.pass(1);
  EXPECT_EQ(three.labels(), Texts{"'/a' left at 2 s, when the wall clock said so"});
  EXPECT_EQ(lines(three.session), Texts{"2000 robot second []"});
  EXPECT_EQ(three.point(2), "3000+0");
}

TEST(Interruption, OfOneInTheMiddleOfItsTurnIsSaidToo) {
  Three three;
  three.stop(1);
  three.leave(1);  // with a report, but the wall clock has said when
  three.cut(1);
  three.report(2, 3 * kSecond);
  three.report(3, 3 * kSecond);
  three.pass(Interruption::kGrace);
  EXPECT_EQ(three.labels(), Texts{"'/a' left at 2 s, when the wall clock said so"});
  EXPECT_EQ(three.point(2), "3000+0");
}

TEST(Interruption, WaitsForAProcessThatIsSlowToEndAndForTheNextOne) {
  Three three;
  three.stop(1);
  three.leaveNow(1);
  three.pass(5 * Interruption::kGrace);
  EXPECT_EQ(three.labels(), Texts{});
  ASSERT_EQ(three.session.status().waiting_for.size(), 3U);
  EXPECT_EQ(three.session.status().waiting_for[0].owes, "its end, which a signal asked for");
  three.cut(1);
  three.pass(Interruption::kGrace / 2);
  three.stop(2);
  three.cut(2);
  three.pass(Interruption::kGrace / 2);
  three.stop(3);
  EXPECT_EQ(three.labels(), Texts{});
  EXPECT_EQ(three.phase(), "idle");
}

TEST(Interruption, OfOneThatNeverEndsHoldsTimeForAWhileOnly) {
  Three three;
  three.report(2, 3 * kSecond);
  three.report(3, 3 * kSecond);
  three.stop(1);
  three.report(1, 3 * kSecond);
  three.pass(kLong);
  EXPECT_EQ(three.point(2), "3000+0");
  EXPECT_EQ(three.labels(), Texts{});  // it is still there
}

TEST(Interruption, LastWordsOfOneAreHeardWhenTheOthersStay) {
  Three three;
  three.report(1, 5 * kSecond);
  three.stop(1);
  three.frame(1, wire::Knock{});
  three.report(2, 5 * kSecond);
  three.report(3, 5 * kSecond);
  EXPECT_EQ(three.point(1), "none");
  EXPECT_EQ(three.labels(), Texts{});
  three.pass(Interruption::kGrace);
  EXPECT_EQ(three.point(1), "2000+1");
  EXPECT_EQ(three.labels(), Texts{"'/a' had input from outside at 2 s"});
}

TEST(Interruption, DeathOfAnotherMeanwhileDegradesTheRunOnlyIfItGoesOn) {
  for (const bool goes_on : {true, false}) {
    Three three;
    three.stop(1);
    three.cut(2);  // the signal was sent to it, too, and it knows none
    three.cut(1);
    three.report(3, 3 * kSecond);
    EXPECT_EQ(three.labels(), Texts{});
    if (goes_on) {
      three.pass(Interruption::kGrace);
      ASSERT_EQ(three.labels().size(), 4U);
      EXPECT_NE(three.labels()[0].find("'/b' ended at 2 s without a word"), std::string::npos);
      EXPECT_NE(three.labels()[3].find("'/b' died at 2 s"), std::string::npos);
    } else {
      three.stop(3);
      EXPECT_EQ(three.labels(), Texts{});
    }
  }
}

TEST(Interruption, DeathOfOneThatWasToldToEndDegradesTheRunOnlyIfItGoesOn) {
  LockstepSettings settings = named({"/a", "/b", "/c"});
  settings.on_death = OnDeath::kEnd;
  Three three(settings);
  three.stop(1);
  three.cut(1);
  three.report(2, 3 * kSecond);
  three.report(3, 3 * kSecond);
  EXPECT_EQ(three.labels(), Texts{});
  three.pass(Interruption::kGrace);
  ASSERT_EQ(three.labels().size(), 2U);
  EXPECT_NE(three.labels()[1].find("'/a' died at 2 s"), std::string::npos);
  EXPECT_EQ(three.phase(), "ended");
  EXPECT_FALSE(three.session.status().ended_as_wished);
}

TEST(Interruption, DeathWithoutAWordIsSaidAtOnceWhoeverEndsAfterIt) {
  Three three;
  three.cut(1);
  EXPECT_EQ(three.labels().size(), 2U);
  three.stop(2);
  three.stop(3);
  EXPECT_EQ(three.labels().size(), 2U);
}

TEST(Interruption, WhoDiesWithoutAWordLabelsTheRun) {
  for (const bool is_told : {true, false}) {
    Three three;
    if (is_told) {
      three.frame(1, wire::Crashing{});
    }
    three.cut(1);
    EXPECT_EQ(three.session.status().degraded.size(), 1U);
    EXPECT_EQ(three.session.status().not_repeatable,
              is_told ? Texts{}
                      : Texts{"'/a' ended at 2 s without a word, as a process that somebody kills "
                              "when the wall clock says so"});
  }
}

TEST(Interruption, WhoIsNoticedFirstOfTwoThatCrashAtOneInstantChangesNothing) {
  for (const auto on_death : {OnDeath::kGoOn, OnDeath::kEnd}) {
    std::vector<std::pair<Texts, std::string>> seen;  // labels, the reason of the end
    for (const auto& order : std::vector<std::vector<ConnectionId>>{{1, 2}, {2, 1}}) {
      LockstepSettings settings = named({"/a", "/b", "/c"});
      settings.on_death = on_death;
      Three three(settings);
      for (const ConnectionId id : order) {
        three.frame(id, wire::Crashing{});
        three.cut(id);
      }
      three.report(3, 3 * kSecond);
      EXPECT_EQ(three.phase() == "ended", on_death == OnDeath::kEnd);
      seen.emplace_back(three.labels(), three.end[3]);
    }
    EXPECT_EQ(seen[0].first.size(), 2U);
    EXPECT_EQ(seen[0], seen[1]);
  }
}

TEST(Strict, WhichOfSeveralDeathsAtOneInstantIsNoticedFirstChangesNothing) {
  std::vector<std::pair<Texts, std::string>> seen;  // labels, the reason of the end
  for (const auto& order : std::vector<std::vector<ConnectionId>>{{1, 2}, {2, 1}}) {
    LockstepSettings settings = named({"/a", "/b", "/c"});
    settings.strict = true;
    Three three(settings);
    for (const ConnectionId id : order) {
      three.frame(id, wire::Crashing{});
      three.cut(id);
    }
    EXPECT_EQ(three.phase(), "running");  // /c may die, too
    three.report(3, 3 * kSecond);
    EXPECT_EQ(three.phase(), "ended");
    EXPECT_EQ(three.end[3].find("strict, and the run is degraded: '/a' died at 2 s"), 0U);
    seen.emplace_back(three.labels(), three.end[3]);
  }
  EXPECT_EQ(seen[0].first.size(), 2U);
  EXPECT_EQ(seen[0], seen[1]);
}

TEST(Strict, TheFirstLabelEndsTheRunBeforeAnythingComesOfIt) {
  LockstepSettings settings = named({"/a", "/b", "/c"});
  settings.strict = true;
  Three three(settings);
  three.frame(1, wire::Knock{});
  EXPECT_EQ(three.phase(), "ended");
  EXPECT_FALSE(three.session.status().ended_as_wished);
  EXPECT_EQ(three.end[2],
            "strict, and the run is not repeatable: '/a' had input from outside at 2 s (noticed at "
            "2 s)");
}

TEST(Strict, CountsWhatParticipantsSayAndDeathsAndRunsThatNameNobody) {
  for (const auto kind : {wire::NoteKind::kNotRepeatable, wire::NoteKind::kDegraded}) {
    LockstepSettings settings = named({"/a", "/b", "/c"});
    settings.strict = true;
    Three three(settings);
    three.report(2, 3 * kSecond);
    three.report(3, 3 * kSecond);
    three.report(1, 3 * kSecond, {wire::Note{kind, "time.time in agent.py, line 7"}});
    EXPECT_NE(three.end[2].find("'/a': time.time in agent.py, line 7"), std::string::npos);
    EXPECT_EQ(three.point(2), "none");
  }
  LockstepSettings settings;
  settings.strict = true;
  settings.settle = 0.0;
  Stage stage(settings);
  stage.join(1, "/a");
  EXPECT_NE(stage.end[1].find("no participants are named"), std::string::npos);
}

TEST(Strict, OneParticipantCanAskForIt) {
  Three three;
  three.report(2, 3 * kSecond);
  three.report(3, 3 * kSecond);
  three.report(1, 3 * kSecond, {wire::Note{wire::NoteKind::kStrict, ""}});
  EXPECT_EQ(three.point(1), "3000+0");
  three.frame(2, wire::Knock{});
  EXPECT_EQ(three.phase(), "ended");
}

TEST(RosMaster, ItsLossLabelsTheRunAndEndsIt) {
  Three three;
  three.session.loseRosMaster("the ROS master is gone");
  three.poll();
  EXPECT_EQ(three.end[1], "the ROS master is gone");
  EXPECT_EQ(three.session.status().degraded, Texts{"the ROS master is gone, found at 2 s"});
  ASSERT_EQ(three.session.status().not_repeatable.size(), 1U);
  EXPECT_NE(three.session.status().not_repeatable[0].find("the ROS master was lost at 2 s"),
            std::string::npos);
}

}  // namespace
}  // namespace move_base_abstract::lockstep_interruption_test
