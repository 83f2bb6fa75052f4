// Mail that arrives later, or never, as those say who carry it.
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "broken.h"
#include "lockstep_news.h"

namespace move_base_abstract::lockstep_carried_test {
namespace {

using namespace lockstep_news;

/** @brief Carries as a function says. */
class By : public Carrier {
 public:
  using Rule = std::function<Carried(const Passage&)>;
  explicit By(Rule rule) : rule_(std::move(rule)) {}
  Carried carry(const Passage& passage) override { return rule_(passage); }

 private:
  Rule rule_;
};

std::unique_ptr<Carrier> by(By::Rule rule) { return std::make_unique<By>(std::move(rule)); }
std::unique_ptr<Carrier> after(Nanoseconds delay) {
  return by([delay](const Passage& passage) { return Carried{passage.from + delay}; });
}

LockstepSettings logged() {
  LockstepSettings settings = named({"/a", "/b"});
  settings.log_messages = true;
  return settings;
}

/** @brief Linked, with a carrier of its mail. */
struct Carried2 : Linked {
  explicit Carried2(std::unique_ptr<Carrier> carrier, const LockstepSettings& settings = logged())
      : Linked(std::move(carrier), settings) {}
  /** @brief /a wakes up at @p wake after it has done @p items; /b waits. */
  void start(Items items, Nanoseconds wake = kNever, std::uint32_t open = 0) {
    report(1, wake, std::move(items), open);
    report(2, kNever);
  }
};

wire::Send news(std::string_view payload, std::uint32_t sub = 0) {
  return {kNews, sub, 0, payload};
}

TEST(Carried, ArrivesAtItsInstantAsAReasonForALeap) {
  Carried2 stage(after(kSecond));
  stage.start({news("x")}, kNever, 1);  // /a waits for what is owed: no deadlock meanwhile
  EXPECT_EQ(grants(stage, 2), Texts{"2000+0: deliver 1 1 x"});
  EXPECT_FALSE(stage.said("deadlock"));
  EXPECT_EQ(lines(stage.session).back().substr(0, 36), "2000 /news message [\"/a\",\"/b\",1,\"af6");
  EXPECT_EQ(stage.session.status().messages, 1U);
  stage.report(2, kNever);
  EXPECT_TRUE(stage.said("deadlock"));
}

TEST(Carried, ComesTogetherWithAWakeUpAndBeforeLaterOnes) {
  Carried2 stage(after(kSecond));
  stage.start({news("x")}, 3 * kSecond);
  EXPECT_EQ(grants(stage, 2), Texts{"2000+0: deliver 1 1 x"});
  stage.report(2, 3 * kSecond);
  EXPECT_EQ(stage.point(1), "3000+0");
  EXPECT_EQ(stage.point(2), "3000+0");
}

TEST(Carried, KeepsTheOrderOfOneLinkWhateverRobotItIs) {
  Nanoseconds due = 4 * kSecond;
  Carried2 stage(by([&due](const Passage&) { return Carried{due}; }));
  stage.start({news("x", 2)}, 2 * kSecond);
  EXPECT_EQ(stage.point(1), "2000+0");
  stage.report(1, kNever, {news("y", 1)});
  EXPECT_EQ(grants(stage, 2), Texts{"4000+0: deliver 1 1 x deliver 1 1 y"});
}

TEST(Carried, WhoIsAskedHearsWhoSendsWhatToWhom) {
  Texts asked;
  Carried2 stage(by([&asked](const Passage& passage) {
    asked.push_back(std::string(passage.sender_name) + " " + std::string(passage.receiver_name) +
                    " " + std::string(passage.name) + " " + std::string(passage.type) + " " +
                    std::to_string(passage.size) + " " + std::to_string(passage.from));
    return Carried{passage.from};
  }));
  stage.start({news("xyz")});
  EXPECT_EQ(asked, Texts{"/a /b /news test/Type 3 1000000000"});
  EXPECT_EQ(grants(stage, 2), Texts{"1000+2: deliver 1 1 xyz"});  // at once, as ever
}

TEST(Carried, OneAfterTheOther) {
  Carried2 stage(after(kSecond));
  stage.session.addCarrier(by([](const Passage& passage) {
    EXPECT_EQ(passage.from, 2 * kSecond);
    return Carried{passage.from + kSecond};
  }));
  stage.start({news("x")});
  EXPECT_EQ(grants(stage, 2), Texts{"3000+0: deliver 1 1 x"});
}

TEST(Carried, WhatIsLostIsInTheLog) {
  Carried2 stage(by([](const Passage& passage) { return Carried{passage.from, "out of range"}; }));
  lines(stage.session);
  stage.start({news("x")});
  EXPECT_EQ(grants(stage, 2), Texts{});
  EXPECT_EQ(stage.phase(), "idle");
  const Texts log = lines(stage.session);
  ASSERT_EQ(log.size(), 1U);
  EXPECT_EQ(log[0].substr(0, 22), "1000 /news lost [\"/a\",");
  EXPECT_NE(log[0].find(",\"out of range\"]"), std::string::npos);
  EXPECT_EQ(stage.session.status().messages, 0U);
}

TEST(Carried, IsDroppedWithItsLink) {
  for (const bool by_sender : {true, false}) {
    Carried2 stage(after(3 * kSecond));
    stage.report(1, by_sender ? 2 * kSecond : kNever, {news("x")});
    stage.report(2, by_sender ? kNever : 2 * kSecond);
    lines(stage.session);
    const ConnectionId who = by_sender ? 1 : 2;
    EXPECT_EQ(stage.point(who), "2000+0");
    stage.report(who, kNever,
                 by_sender ? Items{wire::Unadvertise{kNews}} : Items{wire::Unsubscribe{kNews}});
    const Texts log = lines(stage.session);
    ASSERT_EQ(log.size(), 1U);
    EXPECT_NE(log[0].find("lost"), std::string::npos);
    EXPECT_EQ(stage.point(3 - static_cast<int>(who)), "2000+1");  // told of the link
    stage.report(3 - static_cast<int>(who), kNever);
    EXPECT_EQ(stage.phase(), "idle");  // time does not go on for what was dropped
    EXPECT_EQ(stage.session.now(), 2 * kSecond);
  }
}

TEST(Carried, IsDroppedWithItsReceiver) {
  Carried2 stage(after(3 * kSecond));
  stage.start({news("x")}, 2 * kSecond);
  stage.grant(1);
  stage.cut(2);
  stage.report(1, kNever);
  EXPECT_EQ(stage.point(1), "2000+1");  // told of the link
  stage.report(1, kNever);
  EXPECT_EQ(stage.session.now(), 2 * kSecond);
  EXPECT_EQ(stage.phase(), "idle");
}

TEST(Carried, CallsAndResponsesBothWays) {
  Carried2 stage(after(kSecond));
  stage.start({wire::Call{7, 0, "/do", "please"}}, kNever, 1);
  EXPECT_EQ(grants(stage, 2), Texts{"2000+0: call 1 1 7"});
  stage.report(2, kNever, {wire::Response{1, 7, true, "done"}});
  const auto ok = std::to_string(static_cast<int>(wire::CallStatus::kOk));
  EXPECT_EQ(grants(stage, 1), Texts{"3000+0: answer 7 " + ok});
}

TEST(Carried, ALostCallFailsWhenThatIsNoticed) {
  Carried2 stage(by([](const Passage& passage) {
    return Carried{passage.from + kSecond, "out of range"};
  }));
  stage.start({wire::Call{7, 0, "/do", "please"}}, kNever, 1);
  EXPECT_EQ(grants(stage, 2), Texts{});
  const auto gone = std::to_string(static_cast<int>(wire::CallStatus::kServerGone));
  EXPECT_EQ(grants(stage, 1), Texts{"2000+0: answer 7 " + gone});
}

TEST(Carried, ACallUnderWayFailsWhenItsServerStops) {
  Carried2 stage(after(3 * kSecond));
  stage.report(1, kNever, {wire::Call{7, 0, "/do", "please"}}, 1);
  stage.report(2, 2 * kSecond);
  EXPECT_EQ(stage.point(2), "2000+0");
  stage.report(2, kNever, {wire::Unserve{1}});
  const auto gone = std::to_string(static_cast<int>(wire::CallStatus::kServerGone));
  EXPECT_EQ(grants(stage, 1), Texts{"2000+1: answer 7 " + gone});
  stage.report(1, kNever);
  EXPECT_EQ(stage.session.now(), 2 * kSecond);
}

TEST(Carried, EndsWhatTheReceiverHadPlayed) {
  Carried2 stage(by([](const Passage& passage) {
    return Carried{passage.from + (passage.name == "/news" ? kSecond : 0)};
  }));
  stage.report(1, kNever, {news("x")});
  stage.report(2, 9 * kSecond,
               {wire::Play{kAnswers, 0, 0, false, 0, 3 * kSecond, kNever, "never", {}}});
  EXPECT_EQ(grants(stage, 2), Texts{"2000+0: happened 1000 deliver 1 1 x"});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 1), Texts{});
}

TEST(Carried, WhatIsOnlyPutByIsNoReasonForAGrant) {
  Carried2 stage(after(kSecond));
  stage.report(1, 2 * kSecond);
  stage.report(2, 9 * kSecond, {wire::ChooseDelivery{kNews, wire::Delivery::kUnread}});
  EXPECT_EQ(stage.point(1), "2000+0");
  stage.report(1, kNever, {news("x")});
  EXPECT_EQ(grants(stage, 2), Texts{"9000+0: came 3000000000 deliver 1 1 x came 9000000000"});
}

TEST(Carried, WithALookaheadNothingComesBeforeThatIsOver) {
  for (const auto& [delay, arrival] :
       {std::pair(kSecond / 20, "1300+0: to 1400000000 deliver 1 1 x"),
        std::pair(kSecond, "2200+0: to 2300000000 deliver 1 1 x")}) {
    LockstepSettings settings = logged();
    settings.lookahead = 0.1;
    Carried2 stage(after(delay), settings);
    stage.start({}, 1200 * kSecond / 1000);
    grants(stage, 1);
    stage.report(1, kNever, {news("x")});
    EXPECT_EQ(grants(stage, 2), Texts{arrival});
  }
}

/** @return what /b is handed of mail that is under way until 4 s, and was sent as robots 2 and 1.
 */
TEST(Carried, ItsRuleCanBeBroken) {
  const auto handed = [] {
    Carried2 stage(after(kSecond));
    stage.start({news("x")}, 9 * kSecond);
    return stage.point(2);
  };
  EXPECT_EQ(handed(), "2000+0");
  const Broken broken("arrival_moves_time");
  EXPECT_NE(handed(), "2000+0");
}

}  // namespace
}  // namespace move_base_abstract::lockstep_carried_test
