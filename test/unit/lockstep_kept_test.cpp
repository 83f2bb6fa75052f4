// What a program looks at by itself, and what a user says that it only stores: kept for the next
// grant.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "lockstep/routing/stored_topics.h"
#include "lockstep_client.h"

namespace move_base_abstract::lockstep_kept_test {
namespace {

using Texts = std::vector<std::string>;

constexpr std::uint32_t kPoses = 1;
constexpr std::uint32_t kOrders = 2;
constexpr Nanoseconds kMilli = 1'000'000;

std::string milliText(Nanoseconds time) { return std::to_string(time / kMilli); }

/** @return "time[ms]+microstep: payload, ..." of each grant that @p id got since the last call. */
Texts grants(Stage& stage, ConnectionId id) {
  Texts texts;
  while (const auto next = stage.grant(id)) {
    std::string line = milliText(next->grant.time_ns) + "+" + std::to_string(next->grant.microstep);
    for (const wire::GrantItem& item : next->grant.items) {
      if (const auto* message = std::get_if<wire::Deliver>(&item)) {
        line += " " + std::string(message->payload);
      } else if (const auto* came = std::get_if<wire::Came>(&item)) {
        line += " (" + milliText(came->time_ns) + ")";
      } else if (std::holds_alternative<wire::Publisher>(item)) {
        line += " publisher";
      }
    }
    texts.push_back(line);
  }
  return texts;
}

wire::Send pose(std::string_view payload) { return {kPoses, 0, 0, payload}; }
wire::Send order(std::string_view payload) { return {kOrders, 0, 0, payload}; }

wire::Advertise advertised(std::uint32_t topic, std::string_view name) {
  return {topic, 0, name, "a/Type", "5", false, ""};
}

wire::Subscribe subscribed(std::uint32_t topic, std::string_view name) {
  return {topic, 0, name, "5"};
}

LockstepSettings with(bool keep_unread, std::vector<std::string> stored = {}) {
  LockstepSettings settings = named({"/a", "/b"});
  settings.keep_unread = keep_unread;
  settings.stored_topics = std::move(stored);
  return settings;
}

/** @brief 1 tells poses and orders. 2 looks at poses by itself, and acts on orders. */
struct Linked : Pair {
  explicit Linked(const LockstepSettings& settings = with(true), bool looks = true)
      : Pair(settings) {
    report(1, kNever, {advertised(kPoses, "/poses"), advertised(kOrders, "/orders")});
    const wire::Delivery delivery = looks ? wire::Delivery::kUnread : wire::Delivery::kAll;
    report(2, kNever,
           {subscribed(kPoses, "/poses"), subscribed(kOrders, "/orders"),
            wire::ChooseDelivery{kPoses, delivery}});
    grants(*this, 1);
    grants(*this, 2);
  }

  /** @brief Both have reported; 1 wakes at 1.02 s, and 2 at @p next. */
  void begin(Nanoseconds next, std::vector<wire::ReportItem> items = {}) {
    report(1, 1020 * kMilli);
    report(2, next, std::move(items));
    grants(*this, 1);
    grants(*this, 2);
  }
};

TEST(Kept, WhatIsUnreadComesWithTheReadersOwnWakeUpAndTellsWhenItCame) {
  Linked stage;
  stage.begin(1050 * kMilli);
  stage.report(1, 1040 * kMilli, {pose("a")});
  EXPECT_EQ(grants(stage, 1), Texts{"1040+0"});
  stage.report(1, kNever, {pose("b"), pose("c")});
  EXPECT_EQ(grants(stage, 2), Texts{"1050+0 (1020) a (1040) b c (1050)"});
}

TEST(Kept, ForComparingItComesAtOnce) {
  Linked stage(with(false));
  stage.begin(1050 * kMilli);
  stage.report(1, kNever, {pose("a")});
  EXPECT_EQ(grants(stage, 2), Texts{"1020+1 a"});
}

TEST(Kept, WhatComesForAnotherReasonInItsRoundStandsInTheOneOrder) {
  Linked stage;
  stage.begin(1050 * kMilli);
  stage.report(1, 1040 * kMilli, {pose("a")});
  grants(stage, 1);
  stage.report(1, kNever, {order("go"), pose("b"), order("stop")});
  EXPECT_EQ(grants(stage, 2), Texts{"1040+1 (1020) a (1040) go b stop"});
}

TEST(Kept, ALinkComesBeforeTheMessagesOverIt) {
  Stage stage(with(true));
  stage.join(1, "/a");
  stage.join(2, "/b");
  grants(stage, 1);
  grants(stage, 2);
  stage.report(1, 1020 * kMilli);
  stage.report(
      2, 1050 * kMilli,
      {subscribed(kPoses, "/poses"), wire::ChooseDelivery{kPoses, wire::Delivery::kUnread}});
  grants(stage, 1);
  stage.report(1, kNever, {advertised(kPoses, "/poses"), pose("a")});
  EXPECT_EQ(grants(stage, 2), Texts{"1020+1 publisher a"});
}

TEST(Kept, WithoutAWakeUpOfItsOwnItIsAReasonForAGrant) {
  Linked stage;
  stage.begin(kNever);
  stage.report(1, kNever, {pose("a")});
  EXPECT_EQ(grants(stage, 2), Texts{"1020+1 a"});
  stage.report(2, kNever);
  EXPECT_EQ(stage.phase(), "idle");
}

TEST(Kept, AWakeUpForWhichTimeDoesNotGoOnIsNone) {
  Linked stage;
  stage.begin(1050 * kMilli, {wire::Background{}});
  stage.report(1, kNever, {pose("a")});
  EXPECT_EQ(grants(stage, 2), Texts{"1020+1 a"});
}

TEST(Kept, FromTheInstantOnThatItNamesAGrantMatters) {
  Linked stage;
  stage.begin(1050 * kMilli, {wire::KeepUntil{1030 * kMilli}});
  stage.report(1, 1030 * kMilli, {pose("a")});
  EXPECT_EQ(grants(stage, 2), Texts{});
  grants(stage, 1);
  stage.report(1, kNever, {pose("b")});
  EXPECT_EQ(grants(stage, 2), Texts{"1030+1 (1020) a (1030) b"});
}

TEST(Kept, WhoBeginsToWaitGetsItAtOnce) {
  Linked stage;
  stage.begin(1020 * kMilli);
  stage.report(1, kNever, {pose("a")});
  stage.report(2, kNever, {wire::ChooseDelivery{kPoses, wire::Delivery::kAll}});
  EXPECT_EQ(grants(stage, 2), Texts{"1020+1 a"});
}

TEST(Kept, WhoAsksWhenAllIsDoneIsHandedItBeforeAndGoesOnWithTheOthers) {
  for (const bool keep : {true, false}) {
    Linked stage(with(keep));
    stage.begin(1020 * kMilli);
    stage.report(1, 1050 * kMilli, {pose("a"), wire::Rest{}});
    stage.report(2, 1050 * kMilli, {wire::Rest{}});
    EXPECT_EQ(grants(stage, 2), Texts{"1020+1 a"}) << keep;
    stage.report(2, 1050 * kMilli, {wire::Rest{}});
    EXPECT_EQ(grants(stage, 2), Texts{"1020+2"}) << keep;
    EXPECT_EQ(grants(stage, 1), Texts{"1020+2"}) << keep;
  }
}

TEST(Kept, MuchOfItIsAReasonForAGrant) {
  Linked stage;
  stage.begin(1050 * kMilli);
  const std::string image(std::size_t{1} << 20, 'x');
  stage.report(1, 1030 * kMilli, {pose(image)});
  EXPECT_EQ(grants(stage, 2), Texts{});
  grants(stage, 1);
  stage.report(1, kNever, {pose("b")});
  EXPECT_TRUE(grants(stage, 2) == Texts{"1030+1 (1020) " + image + " (1030) b"});
}

TEST(Stored, WhatTheUserDeclaresComesWithTheNextThingThatTheNodeDoes) {
  for (const char* const entry : {"/poses", "/b=/poses"}) {
    Linked stage(with(true, {entry}), false);
    stage.begin(kNever);
    stage.report(1, 1040 * kMilli, {pose("a")});
    EXPECT_EQ(grants(stage, 1), Texts{"1040+0"});
    stage.report(1, kNever, {order("go"), pose("b")});
    EXPECT_EQ(grants(stage, 2), Texts{"1040+1 a go b"}) << entry;
  }
}

TEST(Stored, ASecondIsTheLatest) {
  Linked stage(with(true, {"/poses"}), false);
  stage.begin(kNever);
  stage.report(1, kNever, {pose("a")});
  EXPECT_EQ(grants(stage, 2), Texts{"2020+0 a"});
}

TEST(Stored, WhatIsDeclaredOfAnotherNodeIsHeardAtOnce) {
  Linked stage(with(true, {"/a=/poses", "/poses/b"}), false);
  stage.begin(kNever);
  stage.report(1, kNever, {pose("a")});
  EXPECT_EQ(grants(stage, 2), Texts{"1020+1 a"});
}

TEST(Stored, NamesAreThoseBelowTheRootAndOthersAreRefused) {
  EXPECT_EQ(checkedStoredTopics({"poses", "a/b=/c", "/d"}), (Texts{"/poses", "/a/b=/c", "/d"}));
  for (const char* const wrong : {"", "=", "/a=", "=/a", "/a=/b=/c", "/a b", "/a//b", "/", "~a"}) {
    EXPECT_THROW(checkedStoredTopics({wrong}), std::invalid_argument) << wrong;
  }
}

TEST(Rounds, TicksOfOneInstantAreOneRoundAndSoAreItsMessagesToOneNode) {
  Linked stage(with(true), false);
  stage.report(1, 1020 * kMilli);
  stage.report(2, 1020 * kMilli);
  const auto before = stage.session.status().rounds;
  EXPECT_EQ(grants(stage, 1), Texts{"1020+0"});
  EXPECT_EQ(grants(stage, 2), Texts{"1020+0"});
  EXPECT_EQ(stage.session.status().rounds, before);
  stage.report(1, kNever, {pose("a"), order("b"), pose("c")});
  stage.report(2, kNever);
  EXPECT_EQ(grants(stage, 2), Texts{"1020+1 a b c"});
  EXPECT_EQ(stage.session.status().rounds, before + 1);
}

TEST(Rounds, WhatIsPlayedAndNobodyIsGrantedForIsNone) {
  Linked stage;
  stage.begin(1050 * kMilli);
  const auto played = [](Nanoseconds at, std::string_view payload) {
    return wire::Play{kPoses, 0, 0, false, 0, at * kMilli, kNever, payload, {}};
  };
  stage.report(1, kNever, {played(1030, "a"), played(1040, "b")});
  EXPECT_EQ(grants(stage, 2), Texts{"1050+0 (1030) a (1040) b (1050)"});
  EXPECT_EQ(stage.session.status().leaps, 4U);
  const auto rounds = stage.session.status().rounds;
  EXPECT_EQ(stage.session.rounds() - rounds, 2U);
}

}  // namespace
}  // namespace move_base_abstract::lockstep_kept_test
