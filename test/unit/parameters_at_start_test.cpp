// What the ROS master tells late of parameters that were set before a run began.
#include "time_master/parameters_at_start.h"

#include <gtest/gtest.h>

namespace move_base_abstract {
namespace {

using Value = XmlRpc::XmlRpcValue;

Value emptyStruct() {
  Value value;
  value.begin();  // makes it a struct
  return value;
}

Value someParameters() {
  Value all;
  all["speed"] = 2;
  all["robot_1"]["laps"] = 3;
  all["robot_10"]["laps"] = 4;
  return all;
}

ParametersAtStart remembered() {
  ParametersAtStart at_start;
  at_start.remember(someParameters());
  return at_start;
}

TEST(ParametersAtStart, WhatIsToldWhileTheRunBeginsWasSetBefore) {
  EXPECT_TRUE(ParametersAtStart().hold("/speed", Value(7)));
}

TEST(ParametersAtStart, TheSameValueIsNoSetFromOutside) {
  const ParametersAtStart at_start = remembered();
  EXPECT_TRUE(at_start.hold("/speed", Value(2)));
  EXPECT_TRUE(at_start.hold("/robot_1/laps", Value(3)));
  EXPECT_TRUE(at_start.hold("/robot_1", someParameters()["robot_1"]));
  EXPECT_TRUE(at_start.hold("/", someParameters()));
}

TEST(ParametersAtStart, AnotherValueIs) {
  const ParametersAtStart at_start = remembered();
  EXPECT_FALSE(at_start.hold("/speed", Value(3)));
  EXPECT_FALSE(at_start.hold("/speed", Value(2.0)));  // of another type
  EXPECT_FALSE(at_start.hold("/robot_1/laps/more", Value(3)));
  EXPECT_FALSE(at_start.hold("/new", Value(2)));
  EXPECT_FALSE(at_start.hold("/speed", emptyStruct()));  // it was there, and is deleted
}

TEST(ParametersAtStart, ADeletionOfWhatWasNotThereIsNone) {
  EXPECT_TRUE(remembered().hold("/new", emptyStruct()));
  EXPECT_TRUE(remembered().hold("/robot_2/laps", emptyStruct()));
}

TEST(ParametersAtStart, WhatAParticipantHasChangedIsKnownNoMore) {
  ParametersAtStart at_start = remembered();
  at_start.change("/robot_1/laps");
  EXPECT_FALSE(at_start.hold("/robot_1/laps", Value(3)));
  EXPECT_FALSE(at_start.hold("/robot_1", someParameters()["robot_1"]));
  EXPECT_FALSE(at_start.hold("/", someParameters()));
  EXPECT_TRUE(at_start.hold("/robot_10/laps", Value(4)));
  EXPECT_TRUE(at_start.hold("/speed", Value(2)));
}

TEST(ParametersAtStart, WhatIsBelowAChangedNameIsChanged) {
  ParametersAtStart at_start = remembered();
  at_start.change("/robot_1");
  EXPECT_FALSE(at_start.hold("/robot_1/laps", Value(3)));
  EXPECT_TRUE(at_start.hold("/robot_10/laps", Value(4)));
}

TEST(ParametersAtStart, WhenTheRosMasterHasNotAnsweredAllIsASetFromOutside) {
  ParametersAtStart at_start;
  at_start.remember(Value());
  EXPECT_FALSE(at_start.hold("/speed", Value(2)));
  EXPECT_FALSE(at_start.hold("/new", emptyStruct()));
}

}  // namespace
}  // namespace move_base_abstract

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
