// What was sent before the end of a run reaches all who hear it, in one last round.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "lockstep_client.h"
#include "lockstep_items.h"

namespace move_base_abstract::lockstep_last_round_test {
namespace {

using Texts = std::vector<std::string>;

constexpr Nanoseconds kMilli = 1'000'000;
constexpr std::uint32_t kTopic = 1;

wire::Send send(std::string_view payload) { return {kTopic, 0, 0, payload}; }
wire::Log line(std::string_view what) { return {0, "r", what, "[]"}; }

/** @return "time[ms]+microstep: payload, ..." of each grant that @p id got since the last call. */
Texts grants(Stage& stage, ConnectionId id) {
  return grants(stage, id, [](const wire::GrantItem& item) {
    const auto* const message = std::get_if<wire::Deliver>(&item);
    const auto* const call = std::get_if<wire::CallIn>(&item);
    return message != nullptr ? std::string(message->payload)
           : call != nullptr  ? "call " + std::string(call->request)
                              : std::string();
  });
}

LockstepSettings endingWithB() {
  LockstepSettings settings = named({"/a", "/b"});
  settings.end_with = {"/b"};
  return settings;
}

/** @brief Both publish and hear one topic, the links are told, and /b wakes at 1.1 s. */
struct Talkers : Pair {
  explicit Talkers(const LockstepSettings& settings = endingWithB(),
                   std::unique_ptr<Carrier> carrier = nullptr)
      : Pair(settings) {
    if (carrier) {
      session.addCarrier(std::move(carrier));
    }
    for (const ConnectionId id : {1, 2}) {
      report(id, kNever, {advertise(kTopic, "/t"), subscribe(kTopic, "/t")});
    }
    grants(*this, 1);
    grants(*this, 2);
    report(1, kNever);
    report(2, 1100 * kMilli);
    grants(*this, 2);
  }

  /** @brief /b sends its last report. */
  void leaveWith(std::vector<wire::ReportItem> items) {
    frame(2, wire::Report{round(2), true, kNever, 0, std::move(items)});
  }
  bool isOver() const { return phase() == "ended"; }
};

TEST(LastRound, WhatOneSendsAndLeavesIsHeardAtTheSameInstant) {
  Talkers both;
  both.leaveWith({send("last")});
  EXPECT_FALSE(both.isOver());
  EXPECT_EQ(grants(both, 1), Texts{"1100+1: last"});
  both.report(1, 1200 * kMilli, {send("unheard"), line("heard it")});
  EXPECT_TRUE(both.isOver());
  EXPECT_EQ(lines(both.session), Texts{"1100 r heard it []"});
  EXPECT_EQ(both.session.now(), 1100 * kMilli);
  EXPECT_EQ(both.session.status().ended_by, ended_by::kDeparture);
  EXPECT_TRUE(both.session.status().ended_as_wished);
  EXPECT_TRUE(both.said("left at 1.1 s"));
  EXPECT_EQ(both.end[1], "'/b' left at 1.1 s, and the run ends with it");
}

TEST(LastRound, WithoutAnythingToHearThereIsNone) {
  Talkers both;
  both.leaveWith({});
  EXPECT_TRUE(both.isOver());
  EXPECT_EQ(grants(both, 1), Texts{});
}

TEST(LastRound, WhatIsSentInItReachesNobodyNotEvenTheOtherHearers) {
  LockstepSettings settings = named({"/a", "/b", "/c"});
  settings.end_with = {"/b"};
  Stage three(settings);
  for (const ConnectionId id : {1, 2, 3}) {
    three.join(id, settings.participants[id - 1]);
  }
  for (const ConnectionId id : {1, 2, 3}) {
    three.grant(id);
    three.report(id, kNever, {advertise(kTopic, "/t"), subscribe(kTopic, "/t")});
  }
  for (const ConnectionId id : {1, 2, 3}) {
    grants(three, id);
    if (id == 2) {
      three.frame(2, wire::Report{three.round(2), true, kNever, 0, {send("last")}});
    } else {
      three.report(id, kNever);
    }
  }
  EXPECT_EQ(grants(three, 1), Texts{"1000+2: last"});
  EXPECT_EQ(grants(three, 3), Texts{"1000+2: last"});
  three.report(1, kNever, {send("answer")});
  EXPECT_EQ(three.phase(), "running");  // /c has not answered yet
  three.report(3, kNever, {send("answer, too")});
  EXPECT_EQ(three.phase(), "ended");
  EXPECT_EQ(grants(three, 1), Texts{});
  EXPECT_EQ(grants(three, 3), Texts{});
}

TEST(LastRound, WhoDiesInItIsToldOfThoughAnotherIsToldToEnd) {
  for (const bool has_reported : {false, true}) {
    LockstepSettings settings = named({"/a", "/b", "/c"});
    settings.end_with = {"/b"};
    Stage three(settings);
    for (const ConnectionId id : {1, 2, 3}) {
      three.join(id, settings.participants[id - 1]);
    }
    for (const ConnectionId id : {1, 2, 3}) {
      three.grant(id);
      three.report(id, kNever, {advertise(kTopic, "/t"), subscribe(kTopic, "/t")});
    }
    for (const ConnectionId id : {1, 2, 3}) {
      grants(three, id);
      three.frame(id, wire::Report{three.round(id), id == 2, kNever, 0,
                                   id == 2 ? std::vector<wire::ReportItem>{send("last")}
                                           : std::vector<wire::ReportItem>{}});
    }
    grants(three, 1);
    grants(three, 3);
    three.frame(1, wire::Stopping{"SIGINT"});
    if (has_reported) {
      three.report(3, kNever);  // its death changes nothing then
    }
    three.frame(3, wire::Crashing{});
    three.cut(3);
    three.report(1, kNever);
    EXPECT_EQ(three.phase(), "ended");
    EXPECT_EQ(three.session.status().degraded.size(), has_reported ? 0U : 1U);
  }
}

TEST(LastRound, ACallWhoseCallerHasGoneIsServed) {
  Pair pair(endingWithB());
  pair.report(1, kNever, {wire::Serve{1, 0, "/do"}});
  pair.report(2, 1100 * kMilli);
  grants(pair, 2);
  pair.frame(2, wire::Report{pair.round(2), true, kNever, 0, {wire::Call{1, 0, "/do", "it"}}});
  EXPECT_EQ(grants(pair, 1), Texts{"1100+1: call it"});
  pair.report(1, kNever);
  EXPECT_EQ(pair.phase(), "ended");
}

TEST(LastRound, WhatOneReportsAndDiesOfIsHeard) {
  LockstepSettings settings = named({"/a", "/b"});
  settings.on_death = OnDeath::kEnd;
  Talkers both(settings);
  both.report(2, 1200 * kMilli, {send("dying")});
  both.cut(2);
  EXPECT_EQ(grants(both, 1), Texts{"1100+1: dying"});
  both.report(1, kNever);
  EXPECT_TRUE(both.isOver());
  EXPECT_FALSE(both.session.status().ended_as_wished);
}

TEST(LastRound, OneWhoDiesOfWhatItHearsDegradesTheRun) {
  Talkers both;
  both.leaveWith({send("last")});
  EXPECT_EQ(grants(both, 1), Texts{"1100+1: last"});
  both.cut(1);
  EXPECT_TRUE(both.isOver());
  EXPECT_EQ(both.session.status().degraded.size(), 1U);
}

TEST(LastRound, WhatIsKeptForALaterGrantIsHandedOverAtTheEndOfTheSettings) {
  LockstepSettings settings = named({"/a", "/b"});
  settings.stored_topics = {"/t"};
  settings.end_at = 1.15;
  Talkers both(settings);
  both.report(2, kNever, {send("kept")});
  EXPECT_EQ(grants(both, 1), Texts{"1150+1: kept"});
  both.report(1, kNever, {send("unheard")});
  both.report(2, kNever);
  EXPECT_TRUE(both.isOver());
  EXPECT_EQ(both.session.status().ended_by, ended_by::kEndAt);
  EXPECT_EQ(both.session.now(), 1150 * kMilli);
}

TEST(LastRound, IsCutShortFromOutside) {
  Talkers both;
  both.leaveWith({send("last")});
  both.session.endFromOutside("enough");
  both.poll();
  EXPECT_TRUE(both.isOver());
  EXPECT_EQ(both.end[1], "'/b' left at 1.1 s, and the run ends with it");
}

TEST(LastRound, DoesNotWaitForThoseWhoAreToldToEndMeanwhile) {
  Talkers both;
  both.leaveWith({send("last")});
  both.frame(1, wire::Stopping{"signal"});
  EXPECT_EQ(grants(both, 1), Texts{"1100+1: last"});
  both.leave(1);
  EXPECT_TRUE(both.isOver());
  EXPECT_TRUE(both.session.status().not_repeatable.empty());
}

TEST(LastRound, ALoopWithoutDelayHasNone) {
  LockstepSettings settings = named({"/a", "/b"});
  settings.end_when_idle = true;
  settings.max_microsteps = 3;
  Talkers both(settings);
  both.report(2, kNever, {send("1")});
  for (int k = 0; k < 5; ++k) {
    for (const ConnectionId id : {1, 2}) {
      if (!grants(both, id).empty()) {
        both.report(id, kNever, {send("again")});
      }
    }
  }
  EXPECT_TRUE(both.isOver());
  EXPECT_EQ(both.session.status().ended_by, ended_by::kZeroDelayLoop);
}

TEST(LastRound, OneThatLeavesInItEndsTheRunNoMore) {
  LockstepSettings settings = named({"/a", "/b"});
  settings.end_with = {"/a", "/b"};
  Talkers both(settings);
  both.leaveWith({send("last")});
  EXPECT_EQ(grants(both, 1), Texts{"1100+1: last"});
  both.leave(1);
  EXPECT_TRUE(both.isOver());
  EXPECT_EQ(both.session.status().ended_with, "/b");
  EXPECT_EQ(both.session.status().departures.size(), 2U);
}

TEST(LastRound, WhatIsPlayedAtItsInstantIsHeardAndWhatComesLaterIsNot) {
  Talkers both;
  both.report(2, 1200 * kMilli, {send("go")});
  EXPECT_EQ(grants(both, 1), Texts{"1100+1: go"});
  grants(both, 2);
  const auto played = [](Nanoseconds at, std::string_view payload) {
    return wire::Play{kTopic, 0, 0, false, 0, at * kMilli, kNever, payload, {}};
  };
  both.report(1, 1900 * kMilli, {played(1200, "due"), played(1300, "late")});
  both.report(2, 1200 * kMilli);
  EXPECT_EQ(grants(both, 2), Texts{"1200+0:"});
  both.leaveWith({send("last")});
  EXPECT_EQ(grants(both, 1), Texts{"1200+1: due last"});
  both.report(1, kNever);
  EXPECT_TRUE(both.isOver());
}

TEST(LastRound, WhatOneWouldReadLaterIsHandedOver) {
  Talkers both;
  both.report(2, 1200 * kMilli, {send("look")});
  EXPECT_EQ(grants(both, 1), Texts{"1100+1: look"});
  grants(both, 2);
  both.report(1, 5 * kSecond, {wire::ChooseDelivery{kTopic, wire::Delivery::kUnread}});
  both.report(2, 1200 * kMilli);
  grants(both, 2);
  both.report(2, 1300 * kMilli, {send("unread")});
  EXPECT_EQ(grants(both, 1), Texts{});
  grants(both, 2);  // its own message
  both.report(2, 1300 * kMilli);
  EXPECT_EQ(grants(both, 2), Texts{"1300+0:"});
  both.leaveWith({send("last")});
  EXPECT_EQ(grants(both, 1), Texts{"1300+1: unread last"});
  both.report(1, kNever);
  EXPECT_TRUE(both.isOver());
}

/** @brief Carries everything for a second. */
class Slow : public Carrier {
 public:
  Carried carry(const Passage& passage) override { return {passage.from + kNanosecondsPerSecond}; }
};

TEST(LastRound, WhatACarrierStillHasIsLost) {
  LockstepSettings settings = named({"/a", "/b"});
  settings.log_messages = true;
  settings.end_at = 1.5;
  Talkers both(settings, std::make_unique<Slow>());
  both.session.takeLog();
  both.report(2, kNever, {send("late")});
  EXPECT_TRUE(both.isOver());
  EXPECT_EQ(grants(both, 1), Texts{});
  const Texts lost = lines(both.session);
  ASSERT_EQ(lost.size(), 2U);  // one for each receiver
  EXPECT_EQ(lost[0].substr(0, 23), "1500 /t lost [\"/b\",\"/a\"");
  EXPECT_NE(lost[0].find("the run ended while it was under way"), std::string::npos);
}

}  // namespace
}  // namespace move_base_abstract::lockstep_last_round_test
