// Connections, departures and labels of the event-driven clock.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "lockstep/session.h"
#include "lockstep/welcome.h"
#include "lockstep_client.h"

namespace move_base_abstract::lockstep_session_test {
namespace {

using Texts = std::vector<std::string>;

// ---- rounds ----------------------------------------------------------------------------------

TEST(Awaited, TheOneGrantedLastOfThoseThatOweTheReport) {
  Pair pair;
  EXPECT_EQ(pair.session.lastAwaited(), 2U);
  pair.report(1, 5 * kSecond);
  EXPECT_EQ(pair.session.lastAwaited(), 2U);
  pair.report(2, 7 * kSecond);  // the round is over, the next one is of the first only
  EXPECT_EQ(pair.session.lastAwaited(), 1U);
}

TEST(Awaited, AnotherOneWhereThatHasReportedOrHasGone) {
  Pair pair;
  pair.report(2, 5 * kSecond);
  EXPECT_EQ(pair.session.lastAwaited(), 1U);
  pair.cut(1);
  pair.report(2, kNever);
  EXPECT_EQ(pair.session.lastAwaited(), 0U);
}

// ---- members ---------------------------------------------------------------------------------

TEST(Members, NamedOnesHaveTheSameIdsWhoeverComesFirst) {
  Stage stage(named({"/a", "/b"}));
  stage.join(1, "/other");
  stage.join(2, "/b");
  stage.join(3, "/a");
  EXPECT_EQ(stage.ids, (std::map<ConnectionId, MemberId>{{1, 3}, {2, 2}, {3, 1}}));
  EXPECT_EQ(stage.members[1], (Texts{"2 /b", "1 /a"}));
  EXPECT_EQ(stage.members[3], (Texts{"2 /b", "3 /other"}));
  EXPECT_EQ(stage.session.status().not_repeatable,
            Texts{"'/other' takes part but is not named in 'participants'"});
}

TEST(Members, OneThatJoinsLateGetsAMicrostepAndALabel) {
  Pair pair;
  pair.report(1, 5 * kSecond);
  pair.join(3, "/late");
  EXPECT_EQ(pair.point(3), "none");
  pair.report(2, 5 * kSecond);
  EXPECT_EQ(pair.point(3), "1000+1");
  EXPECT_EQ(pair.point(1), "none");
  EXPECT_EQ(pair.session.status().not_repeatable, Texts{"'/late' joined at 1 s, after the start"});
}

TEST(Members, ALabelTellsOfNamesThatAreNeverTheSame) {
  Stage stage(named({"/a"}));
  stage.join(1, "/a_4711_1700000000000", 0, false);
  stage.join(2, "/b_4711_1700000000000", 0, true);
  stage.join(3, "/robot_10", 0, false);
  int anonymous = 0;
  for (const std::string& label : stage.session.status().not_repeatable) {
    anonymous += label ==
                 "'/a_4711_1700000000000' has a name of this run only, and no declared rank: its "
                 "place among equal events differs from run to run; give it ~lockstep_rank or a "
                 "name";
    EXPECT_EQ(label.find("'/robot_10' has"), std::string::npos);
    EXPECT_EQ(label.find("'/b_4711_1700000000000' has"), std::string::npos);
  }
  EXPECT_EQ(anonymous, 1);
}

TEST(Members, ThoseThatDeclareNoRankComeAfterTheRobotsWhateverTheySay) {
  Stage stage(named({"/a", "/robot_1", "/robot_2"}));
  stage.join(1, "/a", -7, false);
  stage.join(2, "/robot_1", 0, true);
  stage.join(3, "/robot_2", -1, true);
  EXPECT_EQ(stage.ranks[1], 1000);
  EXPECT_EQ(stage.ranks[3], -1);
  const auto participants = stage.session.status().participants;
  ASSERT_EQ(participants.size(), 3U);
  EXPECT_EQ(participants[0].name + participants[1].name + participants[2].name,
            "/robot_2/robot_1/a");
  EXPECT_EQ(participants[2].rank, 1000);
}

TEST(Members, AreToldWhichTopicsDoNotCountAsTheirNamespaceHasThem) {
  LockstepSettings settings = named({"/robot_1/driver", "/a"});
  settings.excluded_topics = {"/map", "debug", "~trace"};
  Stage stage(settings);
  stage.join(1, "/robot_1/driver");
  stage.join(2, "/a");
  const Texts own{"/clock", "/rosout", "/rosout_agg", "/statistics", "/map"};
  Texts first = own;
  first.insert(first.end(), {"/robot_1/debug", "/robot_1/driver/trace"});
  Texts second = own;
  second.insert(second.end(), {"/debug", "/a/trace"});
  EXPECT_EQ(stage.excluded[1], first);
  EXPECT_EQ(stage.excluded[2], second);
}

TEST(Members, AreAnonymousWithAWallTimeAtTheEndOfTheirName) {
  EXPECT_TRUE(isAnonymous("/rostopic_4711_1600000000000"));
  EXPECT_TRUE(isAnonymous("/play_1600000000000000000"));
  EXPECT_FALSE(isAnonymous("/robot_160000000000"));
  EXPECT_FALSE(isAnonymous("/1600000000000"));
  EXPECT_FALSE(isAnonymous("1600000000000"));
  EXPECT_FALSE(isAnonymous("/robot_1600000000000x"));
}

TEST(Members, TheNewerOfOneNameReplacesTheOlder) {
  Pair pair;
  pair.join(3, "/b");
  EXPECT_TRUE(pair.closed[2]);
  EXPECT_EQ(pair.end[2], "replaced: another '/b' has joined");
  pair.cut(2);
  pair.report(1, 5 * kSecond);
  EXPECT_EQ(pair.point(3), "1000+1");
  pair.report(3, 4 * kSecond);
  EXPECT_EQ(pair.point(3), "4000+0");
  EXPECT_EQ(pair.members[1].back(), "-2");
  EXPECT_TRUE(pair.session.status().degraded.empty());
  EXPECT_FALSE(pair.session.status().not_repeatable.empty());
}

TEST(Members, GoneComesAfterTheGrantThatHasTheLastWords) {
  Pair pair;
  pair.report(1, kNever, {advertise(1, "/x")});
  pair.report(2, kNever, {subscribe(1, "/x")});
  pair.grant(1);
  pair.grant(2);
  pair.frame(1, wire::Report{2, true, kNever, 0, {wire::Send{1, 0, 0, "bye"}}});
  EXPECT_EQ(pair.members[2], Texts{"1 /a"});
  pair.report(2, kNever);
  const auto last = pair.grant(2);
  ASSERT_TRUE(last);
  ASSERT_EQ(last->grant.items.size(), 2U);
  EXPECT_EQ(std::get<wire::Deliver>(last->grant.items[0]).payload, "bye");
  EXPECT_EQ(std::get<wire::NoPublisher>(last->grant.items[1]).sender, 1U);
  EXPECT_EQ(pair.members[2], (Texts{"1 /a", "-1"}));
}

// ---- departures ------------------------------------------------------------------------------

TEST(Departure, WithAReportIsNormal) {
  Pair pair;
  pair.leave(1);
  pair.report(2, 3 * kSecond);
  EXPECT_EQ(pair.point(2), "3000+0");
  EXPECT_TRUE(pair.said("'/a' left at 1 s"));
  pair.cut(1);
  EXPECT_TRUE(pair.session.status().degraded.empty());
  EXPECT_TRUE(pair.session.status().not_repeatable.empty());
  EXPECT_EQ(pair.session.status().participants.size(), 1U);
}

TEST(Departure, WithoutAGrantIsNormalButComesFromTheWall) {
  Pair pair;
  pair.report(1, kNever);
  pair.frame(1, wire::Leave{"shut down"});  // its grant may be on its way: it counts all the same
  pair.report(2, 3 * kSecond);
  pair.cut(1);
  pair.wall += Interruption::kGrace;
  pair.poll();
  EXPECT_EQ(pair.point(2), "3000+0");
  EXPECT_TRUE(pair.said("'/a' left (shut down) at 1 s"));
  EXPECT_TRUE(pair.session.status().degraded.empty());
  EXPECT_EQ(pair.session.status().not_repeatable,
            Texts{"'/a' left at 1 s, when the wall clock said so"});
}

TEST(Departure, OfTheLastOnesWhenAllIsDoneLeavesTheRunRepeatable) {
  Pair pair;
  pair.report(1, kNever);
  pair.report(2, kNever);
  pair.frame(1, wire::Leave{});
  pair.frame(2, wire::Leave{});
  EXPECT_TRUE(pair.session.status().not_repeatable.empty());
  EXPECT_EQ(pair.phase(), "idle");
}

TEST(Departure, DeathIsNamedWithWhatWasOwedAndDegradesTheRun) {
  Pair pair;
  pair.report(2, 3 * kSecond);
  pair.cut(1);
  EXPECT_EQ(pair.point(2), "3000+0");
  EXPECT_EQ(pair.session.status().degraded,
            Texts{"'/a' died at 1 s: its connection was lost while it owed the report of round 1"});
  EXPECT_TRUE(pair.said("the run is degraded", LockstepMessage::Level::kWarn));
  ASSERT_EQ(pair.session.status().departures.size(), 1U);
  EXPECT_EQ(pair.session.status().departures[0].name, "/a");
  EXPECT_EQ(pair.session.status().departures[0].time, kSecond);
  EXPECT_TRUE(pair.session.status().departures[0].died);
}

TEST(Departure, DeathCanEndTheRun) {
  LockstepSettings settings = named({"/a", "/b"});
  settings.on_death = OnDeath::kEnd;
  Pair pair(settings);
  pair.report(2, 3 * kSecond, {wire::Log{0, "robot", "seen", "[]"}});
  pair.cut(1);
  EXPECT_EQ(pair.point(2), "none");
  EXPECT_EQ(pair.phase(), "ended");
  EXPECT_TRUE(pair.closed[2]);
  EXPECT_NE(pair.end[2].find("'/a' died at 1 s"), std::string::npos);
  EXPECT_EQ(lines(pair.session).size(), 1U);  // what had been reported is in the log
}

// ---- silence -------------------------------------------------------------------------------

TEST(Silence, IsToldWithWhatWasToldLastAndWithWhereTheSilentOneIs) {
  Pair pair;
  pair.report(1, kNever, {advertise(1, "/x")});
  pair.report(2, 4 * kSecond, {subscribe(2, "/x"), wire::Serve{1, 0, "/s"}});
  pair.grant(1);
  pair.grant(2);
  pair.report(1, kNever, {wire::Send{1, 0, 0, "data"}, wire::Call{0, 0, "/s", ""}});
  pair.report(2, kNever);
  pair.grant(2);
  const std::uint64_t round = 3;
  pair.frame(2, wire::Busy{round - 1, "an old place"});  // it has reported since
  EXPECT_EQ(pair.session.status().waiting_for[0].where, "");
  pair.frame(2, wire::Busy{round, "agent.py, line 7\n"});
  pair.wall = 12 * kSecond;
  pair.poll();
  const auto waiting = pair.session.status().waiting_for;
  EXPECT_EQ(waiting[0].where, "agent.py, line 7\\x0a");
  EXPECT_EQ(waiting[0].told, "a message on /x of '/a', a call by '/a'");
  EXPECT_TRUE(
      pair.said("it was told last: a message on /x of '/a', a call by '/a'; it is in agent.py, "
                "line 7\\x0a",
                LockstepMessage::Level::kWarn));
  pair.frame(2, wire::Busy{round, "agent.py, line 9"});
  EXPECT_TRUE(pair.said("'/b' is in agent.py, line 9", LockstepMessage::Level::kWarn));
  pair.report(2, kSecond);
  EXPECT_EQ(pair.session.status().waiting_for[0].where, "");  // of the next grant
}

// ---- what is malformed -----------------------------------------------------------------------

TEST(Malformed, OnlyThatConnectionIsClosed) {
  Pair pair;
  pair.report(2, 3 * kSecond);
  pair.bytes(1, std::string("\x01\0\0\0\x63", 5));
  EXPECT_TRUE(pair.closed[1]);
  EXPECT_EQ(pair.end[1], "type of frame must be from 1 to 8, got 99");
  EXPECT_FALSE(pair.closed[2]);
  EXPECT_EQ(pair.point(2), "3000+0");
  EXPECT_EQ(pair.session.status().degraded.size(), 1U);
}

TEST(Malformed, ReportsOfOtherRoundsAreRefused) {
  Pair pair;
  pair.frame(1, wire::Report{2, false, kNever, 0, {}});
  EXPECT_EQ(pair.end[1], "REPORT must be of the round that was granted, 1, got 2");
  pair.frame(2, wire::Report{1, false, kNever, 0, {}});
  pair.frame(2, wire::Report{1, false, kNever, 0, {}});
  EXPECT_EQ(pair.end[2], "REPORT must be of the round that was granted, none, got 1");
}

TEST(Malformed, WhatWasNeverDeclaredDropsItsSenderInItsTurn) {
  Pair pair;
  pair.report(1, kNever, {advertise(1, "/x"), wire::Send{7, 0, 0, ""}});
  EXPECT_FALSE(pair.closed[1]);
  pair.report(2, 3 * kSecond, {subscribe(1, "/x")});
  EXPECT_EQ(pair.end[1], "'/a': SEND must name a topic that was declared, got number 7");
  EXPECT_EQ(pair.point(2), "3000+0");
}

TEST(Malformed, RubbishNeverDoesHarmToOthers) {
  std::mt19937 random(3);
  Pair pair;
  pair.session.step(kSecond);
  pair.report(1, 2 * kSecond);
  pair.report(2, kNever);
  for (ConnectionId id = 10; id < 2'000; ++id) {
    pair.session.connect(id, pair.wall);
    std::string bytes = wire::encode(wire::ParticipantFrame(
        wire::Hello{wire::kProtocol, id % 3 == 0 ? "/rubbish" : "", "", 0, false, 0, ""}));
    for (auto k = random() % 4; k > 0; --k) {
      bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    for (auto k = random() % 60; k > 0; --k) {
      bytes.push_back(static_cast<char>(random() % 6));
    }
    pair.bytes(id, bytes);
    pair.cut(id);
    ASSERT_FALSE(pair.closed[1] || pair.closed[2]);
    while (const auto grant = pair.grant(1)) {
      pair.report(1, grant->grant.time_ns + kSecond);
    }
    pair.session.step(kSecond);
  }
  EXPECT_GT(pair.session.now(), 1'900 * kSecond);
}

TEST(Malformed, GreetingsAreChecked) {
  Stage stage(named({"/a"}));
  stage.session.connect(1, stage.wall);
  stage.frame(1, wire::Knock{});
  EXPECT_EQ(stage.end[1], "the first frame must be HELLO, got another type");
  stage.session.connect(2, stage.wall);
  stage.frame(2, wire::Hello{9, "/a", "", 0, false, 0, ""});
  EXPECT_NE(stage.end[2].find("protocol must be 12, got 9 from '/a'"), std::string::npos);
  stage.session.connect(3, stage.wall);
  stage.frame(3, wire::Hello{wire::kProtocol, "", "", 0, false, 0, ""});
  EXPECT_EQ(stage.end[3], "HELLO must have a name, got an empty one");
  stage.join(4, "/a");
  stage.frame(4, wire::Hello{wire::kProtocol, "/a", "", 0, false, 0, ""});
  EXPECT_EQ(stage.end[4], "HELLO must come once, got another");
  stage.bytes(99, "bytes of an unknown connection");
}

// ---- state and end ---------------------------------------------------------------------------

TEST(State, TellsEverything) {
  LockstepSettings settings = named({"/z", "/robot_10", "/robot_2"});
  settings.limit = 50.0;
  Stage stage(settings);
  stage.join(1, "/z", 0);
  stage.join(2, "/robot_10", 1);
  stage.join(3, "/robot_2", 1);
  stage.grant(1);
  stage.grant(2);
  stage.grant(3);
  stage.session.runUntil(9 * kSecond);
  stage.report(1, 7 * kSecond, {}, 3);
  stage.report(2, kNever);
  stage.frame(2, wire::Knock{});
  const LockstepStatus status = stage.session.status();
  EXPECT_EQ(status.phase, LockstepPhase::kRunning);
  EXPECT_EQ(status.time, kSecond);
  EXPECT_EQ(status.limit, 50.0);
  EXPECT_EQ(status.run_until, 9 * kSecond);
  EXPECT_EQ(status.rounds, 1U);
  ASSERT_EQ(status.waiting_for.size(), 1U);
  EXPECT_EQ(status.waiting_for[0].owes, "the report of round 1");
  ASSERT_EQ(status.participants.size(), 3U);
  EXPECT_EQ(status.participants[0].name, "/z");
  EXPECT_EQ(status.participants[0].next, 7 * kSecond);
  EXPECT_EQ(status.participants[0].open, 3U);
  EXPECT_EQ(status.participants[1].name, "/robot_2");
  EXPECT_TRUE(status.participants[1].owes);
  EXPECT_EQ(status.participants[2].name, "/robot_10");
  EXPECT_EQ(status.participants[2].next, std::nullopt);
  EXPECT_TRUE(status.participants[2].knocked);
  EXPECT_EQ(status.participants[2].node_uri, "http://host:1/");
}

TEST(End, IsToldToEverybodyAlsoToThoseWhoComeLater) {
  Pair pair;
  pair.session.endFromOutside("the time master ends");
  pair.poll();
  EXPECT_EQ(pair.end[1], "the time master ends");
  EXPECT_TRUE(pair.closed[1] && pair.closed[2]);
  EXPECT_EQ(pair.phase(), "ended");
  EXPECT_EQ(pair.session.status().reason, "the time master ends");
  pair.join(3, "/late");
  EXPECT_EQ(pair.end[3], "the time master ends");
  EXPECT_TRUE(pair.closed[3]);
  EXPECT_EQ(pair.session.nextWake(), kNever);
}

}  // namespace
}  // namespace move_base_abstract::lockstep_session_test
