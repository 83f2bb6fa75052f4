// When nothing is left to happen: idle, deadlock, and the end of the run.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "lockstep_client.h"

namespace move_base_abstract::lockstep_standstill_test {
namespace {

TEST(Standstill, DeadlockIsNamedOnceAndCanBeResolved) {
  Alone alone(kNever);
  alone.messages.clear();
  alone.frame(1, wire::Knock{});
  alone.grant(1);
  alone.report(1, kNever, {wire::Note{wire::NoteKind::kWaitsFor, "a result"}}, 2);
  alone.poll();
  EXPECT_EQ(alone.phase(), "deadlock");
  const std::string text =
      "deadlock at 1 s: no participant wants to wake up, but '/a' has 2 waiting threads (a result)";
  EXPECT_EQ(alone.session.status().reason, text);
  EXPECT_EQ(std::count_if(alone.messages.begin(), alone.messages.end(),
                          [&](const auto& message) { return message.text == text; }),
            1);
  alone.frame(1, wire::Knock{});
  EXPECT_EQ(alone.point(1), "1000+2");
  alone.report(1, 2 * kSecond, {}, 2);
  EXPECT_EQ(alone.point(1), "2000+0");
}

/** @brief Two leaps from 1 s. @return the warnings, and then the labels. */
std::vector<std::string> leaps(Nanoseconds first, Nanoseconds second, Nanoseconds machine_clock) {
  LockstepSettings settings = named({"/a"});
  settings.machine_clock = machine_clock;
  Alone alone(first, settings);
  alone.grant(1);
  alone.report(1, second);
  std::vector<std::string> told;
  for (const LockstepMessage& message : alone.messages) {
    if (message.level == LockstepMessage::Level::kWarn) {
      told.push_back(message.text);
    }
  }
  const std::vector<std::string>& labels = alone.session.status().not_repeatable;
  told.insert(told.end(), labels.begin(), labels.end());
  return told;
}

TEST(Standstill, ALeapOfMoreThanADayNamesOnceWhoHasAskedAndToTheMachinesTimeIsALabel) {
  constexpr Nanoseconds kDay = 86400 * kSecond;
  constexpr Nanoseconds kMachine = 1'795'872'674 * kSecond;
  EXPECT_TRUE(leaps(kSecond + kDay, kSecond + 2 * kDay, kMachine).empty());
  const std::string text =
      ", for which '/a' has asked. If that is not meant, look there for a "
      "stamp of the wall clock, or a wrong unit; longest_leap is 86400 s. "
      "Later leaps are not told";
  EXPECT_EQ(leaps(3 * kDay, 6 * kDay, kMachine),
            std::vector<std::string>{"time leaps by 259199 s to 259200 s" + text});
  EXPECT_EQ(
      leaps(3 * kDay, kMachine + 5 * kSecond, kMachine),
      (std::vector<std::string>{"time leaps by 259199 s to 259200 s" + text,
                                "time leaps to the machine's own time, for which '/a' has asked"}));
  EXPECT_EQ(leaps(3 * kDay, kMachine, 0).size(), 1U);
}

TEST(Standstill, WaitsOfADeclaredNodeAreForWork) {
  LockstepSettings settings = named({"/a"});
  settings.idle_nodes = {"/a"};
  settings.end_when_idle = true;
  Stage stage(settings);
  stage.join(1, "/a");
  stage.grant(1);
  stage.report(1, kNever, {wire::Note{wire::NoteKind::kWaitsFor, "a message on /jobs"}}, 1);
  EXPECT_TRUE(stage.session.status().ended_as_wished);
  EXPECT_EQ(stage.session.status().reason,
            "idle at 1 s: no participant wants to wake up; waiting for work: '/a' has 1 waiting "
            "thread (a message on /jobs)");
}

TEST(Standstill, WhoWaitsForWorkIsStuckWhileACallIsOpen) {
  Pair stage;
  stage.report(1, 2 * kSecond);
  stage.report(2, kNever, {wire::Serve{1, 0, "/serve"}, wire::Idle{1}});
  stage.grant(1);
  stage.report(1, kNever, {wire::Call{0, 0, "/serve", ""}}, 0);
  stage.grant(2);
  stage.report(2, kNever, {wire::Idle{1}});
  EXPECT_EQ(stage.phase(), "deadlock");
}

TEST(Standstill, IdleEndsTheRunIfSoConfigured) {
  LockstepSettings settings = named({"/a"});
  settings.end_when_idle = true;
  Alone alone(kNever, settings);
  EXPECT_EQ(alone.phase(), "ended");
  EXPECT_EQ(alone.end[1], "idle at 1 s: no participant wants to wake up");
  EXPECT_TRUE(alone.closed[1]);
  EXPECT_TRUE(alone.session.status().ended_as_wished);
}

TEST(Standstill, ADeadlockAndAZeroDelayLoopEndTheRunIfSoConfiguredAndAreTold) {
  LockstepSettings settings = named({"/a"});
  settings.end_when_idle = true;
  Stage stuck(settings);
  stuck.join(1, "/a");
  stuck.grant(1);
  stuck.report(1, kNever, {wire::Note{wire::NoteKind::kWaitsFor, "a result"}}, 1);
  EXPECT_EQ(stuck.phase(), "ended");
  EXPECT_FALSE(stuck.session.status().ended_as_wished);
  EXPECT_EQ(stuck.session.status().ended_by, ended_by::kDeadlock);
  settings.max_microsteps = 20;
  Stage loop(settings);
  loop.join(1, "/a");
  for (int k = 0; k < 100 && loop.grant(1); ++k) {
    loop.report(1, kSecond);  // at once, again and again
  }
  EXPECT_EQ(loop.phase(), "ended");
  EXPECT_EQ(loop.session.status().ended_by, ended_by::kZeroDelayLoop);
}

class EndWith : public Pair {
 public:
  EndWith() : Pair(settings()) {}

 private:
  static LockstepSettings settings() {
    LockstepSettings settings = named({"/a", "/b"});
    settings.end_with = {"/b"};
    return settings;
  }
};

TEST(Standstill, TheRunEndsWithTheRoundInWhichANamedParticipantLeaves) {
  EndWith stage;
  stage.leave(2);
  EXPECT_EQ(stage.phase(), "running");  // the other one's report of this round counts
  stage.report(1, 2 * kSecond, {wire::Log{0, "r", "done", "[]"}});
  EXPECT_EQ(stage.phase(), "ended");
  EXPECT_EQ(stage.end[1], "'/b' left at 1 s, and the run ends with it");
  EXPECT_EQ(stage.session.status().ended_by, "departure");
  EXPECT_EQ(stage.session.status().ended_with, "/b");
  EXPECT_EQ(stage.session.takeLog().size(), 1U);
  EXPECT_TRUE(stage.session.status().ended_as_wished);
}

TEST(Standstill, TheDeathOfANamedParticipantIsNoGoodEnd) {
  EndWith stage;
  stage.report(1, 2 * kSecond);
  stage.cut(2);
  stage.poll();
  EXPECT_EQ(stage.phase(), "ended");
  EXPECT_FALSE(stage.session.status().ended_as_wished);
}

TEST(Standstill, AnotherParticipantThatLeavesEndsNothing) {
  EndWith stage;
  stage.leave(1);
  stage.report(2, 2 * kSecond);
  EXPECT_EQ(stage.point(2), "2000+0");
}

TEST(ZeroDelay, MoreThanAFrameMayHoldEndsTheRunAndSaysWhose) {
  Stage stage(named({"/a", "/b", "/c"}));
  for (const ConnectionId id : {1U, 2U, 3U}) {
    stage.join(id, id == 1 ? "/a" : id == 2 ? "/b" : "/c");
  }
  const auto opening = [](ConnectionId id) {
    return id == 2 ? std::vector<wire::ReportItem>{wire::Subscribe{1, 0, "/x", "*"},
                                                   wire::Subscribe{2, 0, "/y", "*"}}
                   : std::vector<wire::ReportItem>{
                         wire::Advertise{1, 0, id == 1 ? "/x" : "/y", "t", "m", false, ""}};
  };
  bool is_first = true;
  for (int round = 0; round < 2; ++round, is_first = false) {  // links, then what is said of them
    for (const ConnectionId id : {1U, 2U, 3U}) {
      ASSERT_NE(stage.point(id), "none");
    }
    for (const ConnectionId id : {1U, 2U, 3U}) {
      stage.report(id, id == 2 ? kNever : 2 * kSecond,
                   is_first ? opening(id) : std::vector<wire::ReportItem>{});
    }
  }
  const std::string half(wire::kLargestFrame / 2 + 1, 'x');
  for (const ConnectionId id : {1U, 3U}) {
    ASSERT_EQ(stage.point(id), "2000+0");
  }
  for (const ConnectionId id : {1U, 3U}) {
    stage.report(id, kNever, {wire::Send{1, 0, 0, half}});
  }
  EXPECT_EQ(stage.phase(), "ended");
  EXPECT_NE(stage.end[2].find("'/b' is to be handed 2684354"), std::string::npos) << stage.end[2];
  EXPECT_EQ(stage.end[2], stage.end[1]);
}

}  // namespace
}  // namespace move_base_abstract::lockstep_standstill_test
