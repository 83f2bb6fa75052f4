// The radio in a session: what participants on different hosts hear of each other, and when.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "lockstep_client.h"
#include "lockstep_items.h"
#include "radio_motion.h"

namespace move_base_abstract::radio_session_test {
namespace {

using Texts = std::vector<std::string>;
constexpr std::uint32_t kNews = 1;

/** @brief /base tells news, /robot_1/ear on another host listens, and so does /watch on none. */
struct Air : Stage {
  explicit Air(const std::string& link, const std::string& robot = "at 10 0")
      : Stage(on(link, robot)) {
    join(1, "/base");
    join(2, "/robot_1/ear");
    join(3, "/watch");
    for (const ConnectionId id : {1, 2, 3}) {
      grant(id);
    }
    report(1, kNever, {advertise(kNews, "/news")});
    report(2, kNever, {subscribe(kNews, "/news"), wire::Serve{1, 0, "/do"}});
    report(3, kNever);
    next(1);
    next(2);
  }
  static LockstepSettings on(const std::string& link, const std::string& robot) {
    LockstepSettings settings = named({"/base", "/robot_1/ear", "/watch"});
    settings.network = {"host base at 0 0 /base", "host robot_* " + robot + " /robot_*/**",
                        "wired /wired", "link base robot_* " + link};
    return settings;
  }
  Texts next(ConnectionId id) {
    Texts texts;
    while (const auto one = grant(id)) {
      std::string line = std::to_string(one->grant.time_ns) + ":";
      for (const wire::GrantItem& item : one->grant.items) {
        line += " " + itemText(item);
      }
      texts.push_back(line);
    }
    return texts;
  }
  Texts log() {
    Texts texts;
    for (const LockstepLogEntry& entry : session.takeLog()) {
      texts.push_back(std::to_string(entry.time) + " " + entry.robot + " " + entry.kind + " " +
                      entry.values);
    }
    return texts;
  }
};

wire::Send news(std::string_view payload) { return {kNews, 0, 0, payload}; }

TEST(RadioSession, AMessageArrivesWhenItHasBeenSentAndIsThere) {
  Air air("delay 20000000 20000000 rate 1000");
  EXPECT_EQ(air.log(), (Texts{"1000000000  link [\"base\",\"robot_1\",\"up\"]",
                              "1000000000 base host [0,0]", "1000000000 robot_1 host [10,0]"}));
  air.report(1, kNever, {news("x")});
  air.report(2, kNever);
  EXPECT_EQ(air.next(2), (Texts{"1028000000: deliver 1 1 x"}));
  EXPECT_EQ(air.log(),
            (Texts{"1000000000 /news radio "
                   "[\"base\",\"robot_1\",\"/base\",\"/robot_1/ear\",1,1000000000,1028000000]"}));
}

TEST(RadioSession, WhatIsLostIsInTheLogWithTheReason) {
  Air air("range 9");
  air.log();
  air.report(1, kNever, {news("x")});
  air.report(2, kNever);
  EXPECT_EQ(air.next(2), Texts());
  EXPECT_EQ(air.log(),
            (Texts{"1000000000 /news radio_lost "
                   "[\"base\",\"robot_1\",\"/base\",\"/robot_1/ear\",1,1000000000,\"range\"]"}));
}

TEST(RadioSession, ACallThatIsLostFailsAsABrokenConnection) {
  Air air("range 9");
  air.report(1, kNever, {wire::Call{5, 0, "/do", "?"}});
  air.report(2, kNever);
  EXPECT_EQ(air.next(2), Texts());
  ASSERT_EQ(air.next(1).size(), 1U);
  EXPECT_EQ(air.session.status().phase, LockstepPhase::kRunning);
}

TEST(RadioSession, WhoIsOnNoHostHearsAtOnceAndIsNamed) {
  Air air("range 9");
  air.report(1, kNever, {advertise(2, "/all"), advertise(3, "/wired")});
  air.report(2, kNever, {subscribe(3, "/wired")});
  air.next(1);
  air.report(1, 2 * kSecond);
  air.next(2);
  air.report(2, kNever);
  EXPECT_TRUE(air.session.status().degraded.empty());
  air.next(1);
  air.report(1, kNever, {wire::Send{3, 0, 0, "w"}});
  EXPECT_EQ(air.next(2), (Texts{"2000000000: deliver 3 1 w"}));
}

TEST(RadioSession, AHostWhoseRobotTellsNoMotionIsNamedAndWhatIsSentToItIsLost) {
  for (const bool tells : {false, true}) {
    Air air("range 5", "robot");
    air.report(1, 2 * kSecond);
    if (tells) {
      air.report(2, kNever, {wire::Motion{0, "robot_1", piece(kSecond, 10.0, 0.0)}});
    } else {
      air.report(2, kNever);
    }
    air.next(1);
    air.report(1, 2 * kSecond + 1, {news("x")});
    EXPECT_TRUE(air.session.status().degraded.empty());
    EXPECT_NE(air.log().back().find(tells ? "\"range\"]" : "\"no_place\"]"), std::string::npos);
    air.next(1);
    air.report(1, kNever);
    air.log();
    const auto labels = air.session.status().degraded;
    ASSERT_EQ(labels.size(), tells ? 0U : 1U);
    EXPECT_TRUE(tells || labels[0].find("host 'robot_1' of the network is out of reach wherever "
                                        "places matter") == 0);
  }
}

TEST(RadioSession, HostsWithoutNodesAndNodesOnNoHostAreNamedOnce) {
  Air air("loss 0", "robot");  // where places do not matter
  air.report(1, 3 * kSecond);
  air.report(2, kNever);
  air.next(1);
  air.report(1, kNever);
  air.log();
  EXPECT_TRUE(air.session.status().degraded.empty());
  EXPECT_TRUE(air.said(
      "'/watch' is on no host of the network: the messages that it gets are not on the radio"));
  EXPECT_FALSE(air.said("none of the nodes"));
  LockstepSettings settings = Air::on("range 5", "at 10 0");
  settings.participants = {"/base"};
  Stage alone(settings);
  alone.join(1, "/base");
  alone.grant(1);
  alone.report(1, 3 * kSecond);
  alone.grant(1);
  alone.report(1, kNever);
  alone.session.takeLog();
  EXPECT_TRUE(alone.said("host 'robot_*' of the network has none of the nodes that take part",
                         LockstepMessage::Level::kWarn));
}

TEST(RadioSession, AQueueKeepsItUntilTheRobotComesIntoRange) {
  Air air("range 5 lost queue delay 3 3", "robot");
  air.report(1, kNever, {news("x")});
  air.report(2, 2 * kSecond);
  air.log();
  EXPECT_EQ(air.point(2), "2000+0");
  const std::string drive = piece(2 * kSecond, 10.0, -2.0) + piece(6 * kSecond, 2.0, 0.0);
  air.report(2, kNever, {wire::Motion{0, "robot_1", drive}});
  EXPECT_EQ(air.next(2), (Texts{"4500000003: deliver 1 1 x"}));
  EXPECT_EQ(air.log(),
            (Texts{"4500000000  link [\"base\",\"robot_1\",\"up\"]",
                   "4500000000 /news radio "
                   "[\"base\",\"robot_1\",\"/base\",\"/robot_1/ear\",1,1000000000,4500000003]"}));
}

TEST(RadioSession, ACallIsTriedAgainAndFailsThen) {
  Air air("range 9 lost retry retry 200000000 attempts 2");
  air.report(1, kNever, {wire::Call{5, 0, "/do", "?"}}, 1);
  air.report(2, kNever);
  EXPECT_EQ(air.next(2), Texts());
  const Texts answers = air.next(1);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].substr(0, 11), "1200000000:");
  EXPECT_EQ(air.log().back(),
            "1200000000 /do radio_lost "
            "[\"base\",\"robot_1\",\"/base\",\"/robot_1/ear\",1,1000000000,\"range\"]");
}

TEST(RadioSession, WhoLeavesWhileItIsUnderWayGetsNothing) {
  Air air("delay 500000000 500000000");
  air.report(1, kNever, {news("x")});
  air.report(2, kSecond + 1);
  EXPECT_EQ(air.point(2), "1000+0");
  air.leave(2);
  EXPECT_EQ(air.session.status().messages, 0U);
  EXPECT_EQ(air.session.now(), kSecond + 1);
}

TEST(RadioSession, ALatchedMessageIsSentByRadioToWhoComes) {
  Air air("delay 7 7");
  air.report(1, kNever, {wire::Send{kNews, 0, air.ids[2], "x"}});
  air.report(2, kNever);
  EXPECT_EQ(air.next(2), (Texts{"1000000007: deliver 1 1 x"}));
}

TEST(RadioSession, DelaysOfChaosComeOnTopWhereNothingWaits) {
  LockstepSettings settings = Air::on("lost queue", "at 10 0");
  settings.chaos_seed = 1;
  settings.chaos_delay = 0.5;
  EXPECT_NE(refusal([&] { LockstepSession(settings, 0); }).find("chaos_delay must be 0"),
            std::string::npos);
  settings.network = Air::on("lost drop", "at 10 0").network;
  LockstepSession(settings, 0);
}

TEST(RadioSession, AMotionThatIsNoneEndsItsParticipant) {
  Air air("range 5", "robot");
  air.report(2, kNever, {wire::Motion{0, "robot_1", "none"}});
  air.report(1, kNever);
  EXPECT_NE(air.end[2].find("a motion must have pieces of 80 bytes"), std::string::npos)
      << air.end[2];
  Stage wired(named({"/a"}));
  wired.join(1, "/a");
  wired.grant(1);
  wired.report(1, kNever, {wire::Motion{0, "robot_1", "none"}});
  EXPECT_NE(wired.end[1].find("a motion must have pieces of 80 bytes"), std::string::npos);
}

TEST(RadioSession, RobotsOfAFleetAreOnHostsOfTheirOwn) {
  LockstepSettings settings = named({"/base", "/fleet"});
  settings.network = {"host base at 0 0 /base", "host robot_* robot /robot_*/**",
                      "link base robot_* range 5"};
  Stage stage(settings);
  stage.join(1, "/base");
  stage.join(2, "/fleet");
  stage.grant(1);
  stage.grant(2);
  stage.report(1, 2 * kSecond, {advertise(1, "/one"), advertise(2, "/two")});
  wire::Subscribe one = subscribe(1, "/one"), two = subscribe(2, "/two");
  two.sub = 1;
  stage.report(2, kNever,
               {wire::Motion{0, "robot_1", piece(kSecond, 3.0, 0.0)},
                wire::Motion{1, "robot_2", piece(kSecond, 6.0, 0.0)}, one, two});
  stage.grant(2);
  stage.report(2, kNever);
  stage.grant(1);
  stage.report(1, kNever, {wire::Send{1, 0, 0, "x"}, wire::Send{2, 0, 0, "y"}});
  Texts rows;
  for (const LockstepLogEntry& entry : stage.session.takeLog()) {
    if (entry.kind != "link" && entry.kind != "host") {
      rows.push_back(entry.robot + " " + entry.kind);
    }
  }
  EXPECT_EQ(rows, (Texts{"/one radio", "/two radio_lost"}));
}

}  // namespace
}  // namespace move_base_abstract::radio_session_test
