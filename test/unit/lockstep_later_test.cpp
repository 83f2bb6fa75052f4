// What a subscriber only puts by: it is handed over when there is something else to do.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "lockstep_client.h"
#include "lockstep_items.h"

namespace move_base_abstract::lockstep_later_test {
namespace {

using Texts = std::vector<std::string>;

constexpr std::uint32_t kPoses = 1;
constexpr std::uint32_t kOrders = 2;
constexpr Nanoseconds kMilli = 1'000'000;

/** @return "time[ms]+microstep: payload, ..." of each grant that @p id got since the last call. */
Texts grants(Stage& stage, ConnectionId id) {
  return grants(stage, id, [](const wire::GrantItem& item) {
    const auto* const message = std::get_if<wire::Deliver>(&item);
    return message == nullptr ? std::string() : std::string(message->payload);
  });
}

wire::Send pose(std::string_view payload) { return {kPoses, 0, 0, payload}; }
wire::Send order(std::string_view payload) { return {kOrders, 0, 0, payload}; }

/** @brief 1 tells poses and gives orders; 2 acts on orders, and puts poses by. All are linked. */
struct Linked : Pair {
  Linked() {
    report(1, kNever, {advertise(kPoses, "/tf"), advertise(kOrders, "/orders")});
    report(2, kNever,
           {subscribe(kPoses, "/tf"), subscribe(kOrders, "/orders"),
            wire::ChooseDelivery{kPoses, wire::Delivery::kLater}});
    grants(*this, 1);
    grants(*this, 2);
  }

  /** @brief Both have reported; 1 wakes at @p next. */
  void begin(Nanoseconds next) {
    report(2, kNever);
    report(1, next);
    grants(*this, 1);
  }
};

TEST(Later, WhatIsPutByComesAheadOfWhatComesAndAsksForNoGrant) {
  Linked stage;
  stage.begin(1020 * kMilli);
  stage.report(1, 1040 * kMilli, {pose("a"), pose("b")});
  EXPECT_EQ(grants(stage, 1), Texts{"1040+0:"});
  stage.report(1, kNever, {order("go"), pose("c")});
  EXPECT_EQ(grants(stage, 2), Texts{"1040+1: a b c go"});
}

TEST(Later, OnesOwnWakeUpBringsIt) {
  Linked stage;
  stage.report(2, 1050 * kMilli);
  stage.report(1, 1020 * kMilli);
  grants(stage, 1);
  stage.report(1, kNever, {pose("a")});
  EXPECT_EQ(grants(stage, 2), Texts{"1050+0: a"});
}

TEST(Later, ATenthOfASecondIsTheLatest) {
  Linked stage;
  stage.begin(1020 * kMilli);
  stage.report(1, 1040 * kMilli, {pose("a")});
  grants(stage, 1);
  stage.report(1, kNever, {pose("b")});
  EXPECT_EQ(grants(stage, 2), Texts{"1120+0: a b"});
  stage.report(2, kNever);
  EXPECT_EQ(stage.phase(), "idle");
}

TEST(Later, WhoWantsThemAtOnceGetsWhatWasPutBy) {
  Linked stage;
  stage.report(2, 1020 * kMilli);
  stage.report(1, 1020 * kMilli);
  grants(stage, 1);
  grants(stage, 2);
  stage.report(1, kNever, {pose("a")});
  stage.report(2, kNever, {wire::ChooseDelivery{kPoses, wire::Delivery::kAll}});
  EXPECT_EQ(grants(stage, 2), Texts{"1020+1: a"});
}

TEST(Later, TheOrderIsThatInWhichTheyWouldHaveCome) {
  Stage stage(named({"/a", "/b", "/c"}));
  for (const ConnectionId id : {1U, 2U, 3U}) {
    stage.join(id, std::string("/") + "abc"[id - 1]);
  }
  grants(stage, 1);
  grants(stage, 2);
  grants(stage, 3);
  stage.report(1, 1020 * kMilli, {advertise(kPoses, "/tf")});
  stage.report(2, 1010 * kMilli, {advertise(kPoses, "/tf")});
  stage.report(3, kNever,
               {subscribe(kPoses, "/tf"), wire::ChooseDelivery{kPoses, wire::Delivery::kLater}});
  for (const ConnectionId id : {1U, 2U, 3U}) {
    grants(stage, id);
  }
  stage.report(1, 1020 * kMilli);
  stage.report(2, 1010 * kMilli);
  stage.report(3, kNever);
  grants(stage, 2);
  stage.report(2, 1020 * kMilli, {pose("b1"), pose("b2")});  // at 1.01 s
  grants(stage, 1);
  grants(stage, 2);
  stage.report(2, kNever, {pose("b3")});  // at 1.02 s, both
  stage.report(1, kNever, {pose("a")});
  EXPECT_EQ(grants(stage, 3), Texts{"1110+0: b1 b2 a b3"});
}

}  // namespace
}  // namespace move_base_abstract::lockstep_later_test
