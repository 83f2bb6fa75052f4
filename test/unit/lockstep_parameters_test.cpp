// Parameters of ROS that participants set: in which order, when, and what labels the run.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "lockstep_client.h"
#include "lockstep_items.h"

namespace move_base_abstract::lockstep_parameters_test {
namespace {

using Texts = std::vector<std::string>;

constexpr const char* kOneAsXml = "<value><i4>1</i4></value>";

wire::Parameter set(std::string_view name, std::string_view value = kOneAsXml) {
  return {name, true, value};
}
wire::Parameter erased(std::string_view name) { return {name, false, ""}; }

/** @return "who: name" of what the ROS master is to be told, a deletion with a "-". */
Texts told(Stage& stage) {
  Texts texts;
  for (const ParameterChange& change : stage.session.takeParameters()) {
    texts.push_back(change.by + ": " + (change.value.empty() ? "-" : "") + change.name);
  }
  return texts;
}

struct Two : Stage {
  Two() : Stage(named({"/a", "/b"})) {
    join(1, "/b", 5);
    join(2, "/a", 5);
    grant(1);
    grant(2);
  }
  Texts labels() const { return session.status().not_repeatable; }
};

TEST(Parameters, TheRosMasterIsToldWhenTheRoundIsOverInTheStatedOrder) {
  Two stage;
  stage.report(1, kSecond, {set("/x"), erased("/x"), set("/y")});
  EXPECT_EQ(told(stage), Texts{});  // the other one may still ask
  stage.report(2, kSecond, {set("/x")});
  EXPECT_EQ(told(stage), (Texts{"/a: /x", "/b: /x", "/b: -/x", "/b: /y"}));
  EXPECT_EQ(told(stage), Texts{});
  EXPECT_EQ(stage.labels(), Texts{});
}

/** @return whether the next grant of @p id tells it that something that it asks for has changed. */
bool isToldOfChange(Two& stage, ConnectionId id) {
  const auto next = stage.grant(id);
  return next && !next->grant.items.empty() &&
         std::holds_alternative<wire::Changed>(next->grant.items.front());
}

TEST(Parameters, WhoHasAskedIsToldOfAChangeWithItsNextGrantOnce) {
  Two stage;
  // It asks, in this round or before it, for the same, for what is above it and for what is below.
  for (const char* const asked : {"/x/y", "/x", "/x/y/z"}) {
    stage.report(1, kSecond, {wire::Asks{asked}});
    stage.report(2, kSecond, {set("/x/y")});
    EXPECT_TRUE(isToldOfChange(stage, 1)) << asked;
    EXPECT_FALSE(isToldOfChange(stage, 2)) << asked;
    stage.report(1, kSecond);
    stage.report(2, kSecond);
    EXPECT_FALSE(isToldOfChange(stage, 1)) << asked;
    EXPECT_FALSE(isToldOfChange(stage, 2)) << asked;
  }
  stage.report(1, kSecond);
  stage.report(2, kSecond, {set("/xy"), erased("/a")});
  EXPECT_FALSE(isToldOfChange(stage, 1));
}

TEST(Parameters, AChangeIsNoReasonForAGrantAndOneFromOutsideIsToldToo) {
  Two stage;
  stage.report(1, kSecond + 20, {wire::Asks{"/x"}});
  stage.report(2, kSecond + 10, {set("/x")});
  EXPECT_FALSE(isToldOfChange(stage, 1));
  EXPECT_FALSE(isToldOfChange(stage, 2));
  stage.report(2, kNever);
  EXPECT_TRUE(isToldOfChange(stage, 1));
  stage.session.parameterChangedOutside("/x");
  stage.report(1, kSecond + 30);
  EXPECT_TRUE(isToldOfChange(stage, 1));
}

TEST(Parameters, OfOneWhoDiesThoseCountThatItHasReported) {
  Two stage;
  stage.report(1, kSecond, {set("/x")});
  stage.cut(1);
  stage.report(2, kSecond);
  EXPECT_EQ(told(stage), Texts{"/b: /x"});
}

TEST(Parameters, WhoLeavesHasItsLastOnesSet) {
  Two stage;
  stage.report(2, kSecond);
  stage.frame(1, wire::Report{1, true, kNever, 0, {set("/x")}});
  EXPECT_EQ(told(stage), Texts{"/b: /x"});
}

TEST(Parameters, OneWithoutAnAbsoluteNameOrAValueEndsItsConnection) {
  for (const wire::Parameter& bad :
       {set("x"), set(""), set("/x", ""), wire::Parameter{"/x", false, kOneAsXml}}) {
    Two stage;
    stage.report(1, kSecond, {bad});
    stage.report(2, kSecond);
    EXPECT_TRUE(stage.closed[1]);
    EXPECT_EQ(told(stage), Texts{});
  }
}

TEST(Parameters, WhatOthersSetLabelsTheRunWhereItIsAskedFor) {
  Two stage;
  stage.session.parameterChangedOutside("/idle");
  stage.report(1, kSecond, {wire::Asks{"/team/size"}, wire::Asks{"/speed"}});
  stage.report(2, kSecond);
  for (const char* other : {"/other", "/team/sizes", "/team/siz", "/speedy/x"}) {
    stage.session.parameterChangedOutside(other);
  }
  EXPECT_EQ(stage.labels(), Texts{});
  stage.session.parameterChangedOutside("/team");
  stage.session.parameterChangedOutside("/team/");
  const std::string label =
      "parameter /team was set or deleted by a program that does not take part, and /b asks for it";
  EXPECT_EQ(stage.labels(), Texts{label});
  stage.session.parameterChangedOutside("/speed/x");
  EXPECT_EQ(stage.labels().size(), 2U);
}

TEST(Parameters, WhoAsksLaterForWhatOthersHaveSetIsLabelledToo) {
  Two stage;
  stage.session.parameterChangedOutside("/team/size");
  stage.report(1, kSecond, {wire::Asks{"/teams"}});
  stage.report(2, kSecond);
  EXPECT_EQ(stage.labels(), Texts{});
  stage.poll();
  stage.grant(1);
  stage.report(1, kSecond, {wire::Asks{"/"}});
  stage.grant(2);
  stage.report(2, kSecond);
  EXPECT_EQ(stage.labels().size(), 1U);
}

TEST(Parameters, WhatIsThereWhenTheRunBeginsLabelsNothing) {
  Stage stage(named({"/a", "/b"}));
  stage.join(1, "/a");
  stage.session.parameterChangedOutside("/x");
  stage.join(2, "/b");
  stage.grant(1);
  stage.grant(2);
  stage.report(1, kSecond, {wire::Asks{"/x"}});
  stage.report(2, kSecond);
  EXPECT_TRUE(stage.session.status().not_repeatable.empty());
}

TEST(Parameters, WhatIsSetWhileAllAreToldToEndLabelsNothing) {
  Two stage;
  stage.report(1, kSecond, {wire::Asks{"/x"}});
  stage.report(2, kSecond);
  stage.frame(2, wire::Stopping{"a signal"});
  stage.session.parameterChangedOutside("/x");
  EXPECT_EQ(stage.labels(), Texts{});
}

TEST(Parameters, WhatTheRosMasterDoesNotTakeLabelsTheRun) {
  Two stage;
  stage.session.parameterNotTaken({"/a", "/x", kOneAsXml});
  EXPECT_EQ(stage.labels(), Texts{"the ROS master has not taken parameter /x of /a"});
}

}  // namespace
}  // namespace move_base_abstract::lockstep_parameters_test
