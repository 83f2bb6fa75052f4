// With a lookahead: windows of simulated time through which participants go by themselves.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lockstep_client.h"

namespace move_base_abstract::lockstep_windows_test {
namespace {

constexpr Nanoseconds kMilli = 1'000'000;

LockstepSettings ahead(std::vector<std::string> names, double lookahead = 0.05) {
  LockstepSettings settings = named(std::move(names));
  settings.lookahead = lookahead;
  return settings;
}

/** @return the grant as text: when, what comes then, and what later in its window. */
std::string text(const std::optional<ClientGrant>& granted) {
  if (!granted) {
    return "none";
  }
  const auto ms = [](Nanoseconds time) { return std::to_string(time / kMilli); };
  std::string text = ms(granted->grant.time_ns);
  for (const wire::GrantItem& item : granted->grant.items) {
    if (const auto* window = std::get_if<wire::Window>(&item)) {
      text += " to " + ms(window->end_ns);
    } else if (const auto* later = std::get_if<wire::Arrives>(&item)) {
      text += " " + ms(later->time_ns) + ":";
    } else if (const auto* message = std::get_if<wire::Deliver>(&item)) {
      text += " " + std::string(message->payload);
    } else if (const auto* call = std::get_if<wire::CallIn>(&item)) {
      text += " call " + std::string(call->request);
    } else if (const auto* answer = std::get_if<wire::Answer>(&item)) {
      text += " answer " + std::string(answer->bytes);
    } else if (std::holds_alternative<wire::Changed>(item)) {
      text += " changed";
    } else {
      text += " link";
    }
  }
  return text;
}

wire::Send send(std::string_view payload) { return {1, 0, 0, payload}; }
wire::Log note(std::string_view what) { return {0, "r", what, "[]"}; }

/** @brief Both publish and hear one topic; it is 1100 ms, and the links are told. */
struct Talkers : Stage {
  explicit Talkers(const LockstepSettings& settings = ahead({"/a", "/b"})) : Stage(settings) {
    join(1, settings.participants[0]);
    join(2, settings.participants[1]);
    for (const ConnectionId id : {1, 2}) {
      grant(id);
      report(id, 1100 * kMilli, {advertise(1, "/t"), subscribe(1, "/t")});
    }
    for (const ConnectionId id : {1, 2}) {
      EXPECT_EQ(text(grant(id)), "1050 to 1100 link link link link");
      report(id, 1100 * kMilli);
    }
  }
};

TEST(Windows, AMessageArrivesExactlyTheLookaheadLaterAlsoInTheMiddleOfAWindow) {
  Talkers both;
  EXPECT_EQ(text(both.grant(1)), "1100 to 1150");
  EXPECT_EQ(text(both.grant(2)), "1100 to 1150");
  both.report(1, 1400 * kMilli, {send("x"), wire::At{1120 * kMilli}, send("y")});
  both.report(2, 1160 * kMilli);
  // To its sender as well. All is told that arrives before the window ends.
  EXPECT_EQ(text(both.grant(1)), "1150 to 1200 x 1170: y");
  EXPECT_EQ(text(both.grant(2)), "1150 to 1200 x 1170: y");
}

TEST(Windows, OneRoundIsOneWindowAndSilenceIsLeaptOver) {
  Talkers both;
  both.grant(1);
  both.grant(2);
  const auto rounds = both.session.status().rounds;
  both.report(1, 9 * kSecond, {note("a"), wire::At{1110 * kMilli}, note("b")});
  both.report(2, 7 * kSecond, {wire::At{1149 * kMilli}, note("c")});
  EXPECT_EQ(text(both.grant(2)), "7000 to 7050");
  EXPECT_EQ(text(both.grant(1)), "none");
  EXPECT_EQ(both.session.status().rounds, rounds + 1);
}

TEST(Windows, TheLogIsInTheOrderOfTimeThenOfNamesThenOfEachOne) {
  Talkers both;
  both.grant(1);
  both.grant(2);
  both.report(2, kNever, {note("2"), wire::At{1110 * kMilli}, note("5"), note("6")});
  both.report(1, kNever,
              {note("1"), wire::At{1105 * kMilli}, note("3"), wire::At{1110 * kMilli}, note("4")});
  EXPECT_EQ(lines(both.session),
            (std::vector<std::string>{"1100 r 1 []", "1100 r 2 []", "1105 r 3 []", "1110 r 4 []",
                                      "1110 r 5 []", "1110 r 6 []"}));
  EXPECT_EQ(both.phase(), "idle");
  EXPECT_EQ(both.session.now(), 1110 * kMilli);
}

TEST(Windows, WhoReportsEarlyIsGrantedTheRestAndNothingIsToldBeforeAllHaveComeSoFar) {
  Talkers both;
  both.grant(1);
  both.grant(2);
  both.report(1, 1110 * kMilli, {note("early")});
  both.report(2, kNever, {wire::At{1140 * kMilli}, note("late"), send("x")});
  EXPECT_EQ(lines(both.session), std::vector<std::string>{"1100 r early []"});
  EXPECT_EQ(text(both.grant(1)), "1110 to 1160");
  EXPECT_EQ(text(both.grant(2)), "none");
  both.report(1, kNever, {note("then")});
  EXPECT_EQ(lines(both.session), (std::vector<std::string>{"1110 r then []", "1140 r late []"}));
  EXPECT_EQ(text(both.grant(1)), "1190 to 1240 x");
}

TEST(Windows, ACallAndItsAnswerTakeTheLookaheadEach) {
  Talkers both;
  both.grant(1);
  both.grant(2);
  both.report(1, kNever, {wire::Serve{1, 0, "/s"}});
  both.report(2, kNever, {wire::At{1110 * kMilli}, wire::Call{1, 0, "/s", "q"}});
  EXPECT_EQ(text(both.grant(1)), "1160 to 1210 call q");
  both.report(1, kNever, {wire::At{1200 * kMilli}, wire::Response{both.ids[2], 1, true, "r"}});
  EXPECT_EQ(text(both.grant(2)), "1250 to 1300 answer r");
}

TEST(Windows, WhatIsSetIsToldBeforeItsNodeGoesOnAndNotBeforeOthersHaveComeSoFar) {
  Talkers both;
  both.grant(1);
  both.grant(2);
  both.report(1, 1120 * kMilli);
  both.report(2, 1145 * kMilli,
              {wire::At{1140 * kMilli}, wire::Parameter{"/p", true, "<value>1</value>"}});
  EXPECT_TRUE(both.session.takeParameters().empty());
  EXPECT_EQ(text(both.grant(1)), "1120 to 1170");
  EXPECT_EQ(text(both.grant(2)), "none");  // though nothing can reach it before 1170
  both.report(1, 1150 * kMilli);
  EXPECT_EQ(both.session.takeParameters().size(), 1U);
  EXPECT_EQ(text(both.grant(2)), "1145 to 1195");
}

TEST(Windows, WhoHasAskedIsToldOfAChangeAlsoOfOneThatIsAppliedBeforeTheInstantAtWhichItAsked) {
  Talkers both;
  both.grant(1);
  both.grant(2);
  both.report(1, 1120 * kMilli,
              {wire::At{1110 * kMilli}, wire::Parameter{"/p", true, "<value>1</value>"}});
  both.report(2, 1160 * kMilli, {wire::At{1140 * kMilli}, wire::Asks{"/p"}});
  EXPECT_EQ(text(both.grant(1)), "1120 to 1170");
  EXPECT_EQ(text(both.grant(2)), "1160 to 1170 changed");
  both.report(1, 1180 * kMilli);
  both.report(2, kNever);
  EXPECT_EQ(text(both.grant(1)), "1180 to 1230");
}

TEST(Windows, WhatSeveralSetIsToldInTheOrderOfTimeThenOfNames) {
  Talkers both;
  both.grant(1);
  both.grant(2);
  const auto set = [](const char* name) { return wire::Parameter{name, true, "<value>1</value>"}; };
  both.report(2, kNever,
              {wire::At{1120 * kMilli}, set("/second"), wire::At{1130 * kMilli}, set("/last")});
  both.report(1, kNever,
              {wire::At{1110 * kMilli}, set("/first"), wire::At{1130 * kMilli}, set("/third")});
  std::vector<std::string> names;
  for (const auto& change : both.session.takeParameters()) {
    names.push_back(change.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"/first", "/second", "/third", "/last"}));
}

TEST(Windows, WhatArrivesAtOneInstantComesByRobotWhateverTheOrderInWhichItWasSent) {
  Talkers both;
  both.grant(1);
  both.grant(2);
  both.report(1, kNever, {wire::Send{1, 7, 0, "of 7"}, wire::Send{1, 2, 0, "of 2"}});
  both.report(2, kNever);
  EXPECT_EQ(text(both.grant(2)), "1150 to 1200 of 2 of 7");
}

TEST(Windows, WhoLooksWhoIsThereIsGrantedAloneWhenAllOthersHaveComeSoFar) {
  Talkers both;
  both.grant(1);
  both.grant(2);
  both.report(1, 1130 * kMilli);
  both.report(2, kNever, {wire::At{1140 * kMilli}, wire::Rest{}});
  EXPECT_EQ(text(both.grant(1)), "1130 to 1180");
  EXPECT_EQ(text(both.grant(2)), "none");
  both.report(1, 1180 * kMilli);
  EXPECT_EQ(text(both.grant(2)), "1140 to 1140");  // this instant only
  EXPECT_EQ(text(both.grant(1)), "none");
  both.report(2, kNever);
  EXPECT_EQ(text(both.grant(1)), "1180 to 1230");
}

LockstepSettings endingWithB() {
  LockstepSettings settings = ahead({"/a", "/b"});
  settings.end_with = {"/b"};
  return settings;
}

/** @brief Both are granted what comes from 1100 ms on, and the run ends with /b. */
struct Ending : Talkers {
  Ending() : Talkers(endingWithB()) {
    grant(1);
    grant(2);
  }

  /** @brief /b sends its last report. */
  void leaveWith(std::vector<wire::ReportItem> items) {
    frame(2, wire::Report{round(2), true, kNever, 0, std::move(items)});
  }
};

TEST(Windows, TheRunEndsAtTheInstantAtWhichTheOneLeavesThatItEndsWith) {
  Ending both;
  both.report(1, kNever,
              {wire::At{1110 * kMilli}, note("in time"), wire::At{1111 * kMilli}, note("after")});
  both.leaveWith({wire::At{1110 * kMilli}});
  EXPECT_EQ(lines(both.session), std::vector<std::string>{"1110 r in time []"});
  EXPECT_EQ(both.phase(), "ended");
  EXPECT_TRUE(both.said("left at 1.11 s"));
}

TEST(Windows, TheRunEndsAtTheLatestInstantOfOneWhoseDeathEndsIt) {
  Ending both;
  both.report(2, kNever, {wire::At{1120 * kMilli}, send("y"), note("in time")});
  both.cut(2);
  both.report(1, 1500 * kMilli, {send("x"), wire::At{1121 * kMilli}, note("after"), send("z")});
  EXPECT_EQ(text(both.grant(1)), "1150 to 1170 x 1170: y link link");
  both.report(1, kNever);
  EXPECT_EQ(both.phase(), "ended");
  EXPECT_EQ(both.session.now(), 1120 * kMilli);
  EXPECT_EQ(lines(both.session), std::vector<std::string>{"1120 r in time []"});
}

TEST(Windows, WhatOthersSayAtTheInstantOfADeathThatEndsTheRunCounts) {
  Ending both;
  both.cut(2);  // before it has reported
  both.report(1, 1500 * kMilli, {note("in time"), wire::At{1101 * kMilli}, note("after")});
  EXPECT_EQ(both.phase(), "ended");
  EXPECT_EQ(lines(both.session), std::vector<std::string>{"1100 r in time []"});
}

TEST(Windows, WhatIsUnderWayAtTheEndIsHeardAtItsInstantAndNothingLaterCounts) {
  Ending both;
  both.report(1, 1155 * kMilli, {send("w"), wire::At{1130 * kMilli}, send("after")});
  both.leaveWith({send("x"), wire::At{1120 * kMilli}, send("y"), note("in time")});
  EXPECT_EQ(text(both.grant(1)), "1150 to 1170 w x 1170: y link link");
  both.report(1, kNever, {send("unheard"), note("too late"), wire::At{1155 * kMilli}, note("own")});
  EXPECT_EQ(both.phase(), "ended");
  EXPECT_EQ(lines(both.session), std::vector<std::string>{"1120 r in time []"});
  EXPECT_TRUE(both.said("the run ended at 1.12 s"));
}

TEST(Windows, WhatSeveralDoAtOneInstantIsAppliedInTheOrderOfNamesNotOfJoining) {
  const auto label = [](std::string_view why) {
    return wire::Note{wire::NoteKind::kNotRepeatable, why};
  };
  Talkers both(ahead({"/b", "/a"}));
  both.grant(1);
  both.grant(2);
  both.report(1, kNever, {label("first to report")});
  both.report(2, kNever, {label("second")});
  EXPECT_EQ(both.session.status().not_repeatable,
            (std::vector<std::string>{"'/a': second", "'/b': first to report"}));
}

TEST(Windows, WhoDiesInOneRoundHasGoneInTheOrderOfNames) {
  Talkers both(ahead({"/b", "/a"}));
  both.grant(1);
  both.grant(2);
  both.cut(1);
  both.cut(2);
  std::vector<std::string> names;
  for (const LockstepStatus::Departure& departure : both.session.status().departures) {
    names.push_back(departure.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"/a", "/b"}));
}

TEST(Windows, ATargetEndsTheWindowAndOneInTheWindowUnderWayIsRefused) {
  Talkers both;
  both.grant(1);
  both.grant(2);
  EXPECT_EQ(refusal([&] { both.session.runUntil(1120 * kMilli); }).substr(0, 59),
            "run_until: target must be from the present, 1.149999999 s, ");
  both.session.runUntil(1160 * kMilli);
  both.report(1, 1150 * kMilli);
  both.report(2, 1170 * kMilli);
  const auto granted = both.grant(1);
  EXPECT_EQ(std::get<wire::Window>(granted->grant.items[0]).end_ns, 1160 * kMilli + 1);
  both.report(1, 1161 * kMilli);
  EXPECT_EQ(both.phase(), "paused");
  EXPECT_EQ(both.session.now(), 1160 * kMilli);
}

TEST(Windows, APauseHoldsTheNextWindowBack) {
  Talkers both;
  both.grant(1);
  both.grant(2);
  both.session.pause();
  both.report(1, 1150 * kMilli);
  both.report(2, kNever);
  EXPECT_EQ(text(both.grant(1)), "none");
  both.session.resume();
  both.poll();
  EXPECT_EQ(text(both.grant(1)), "1150 to 1200");
}

TEST(Windows, WhoHasDiedIsHeardToTheEndAndCallsToItFail) {
  Talkers both;
  both.grant(1);
  both.grant(2);
  both.report(1, kNever, {wire::Serve{1, 0, "/s"}, send("x")});
  both.report(2, kNever, {wire::At{1110 * kMilli}, wire::Call{1, 0, "/s", "q"}});
  both.grant(2);
  both.report(2, kNever);
  both.cut(1);
  EXPECT_EQ(text(both.grant(2)), "1200 to 1250 answer  link link");
}

TEST(Windows, ATurnOutsideOfItsWindowEndsTheConnectionThatTellsIt) {
  Talkers both;
  both.grant(1);
  both.grant(2);
  both.report(1, kNever, {wire::At{1150 * kMilli}});
  EXPECT_TRUE(both.closed[1]);
  EXPECT_TRUE(both.said("AT must be from 1.1 s on and before the end of the window, 1.15 s"));
}

TEST(Windows, AnEndlessLoopAtOneInstantIsNamed) {
  LockstepSettings settings = ahead({"/a", "/b"});
  settings.max_microsteps = 10;
  Talkers both(settings);
  both.grant(2);
  both.report(2, kNever);
  for (int k = 0; k < 30 && both.grant(1); ++k) {
    both.report(1, 1100 * kMilli);
  }
  EXPECT_EQ(both.phase(), "zero_delay_loop");
}

}  // namespace
}  // namespace move_base_abstract::lockstep_windows_test
