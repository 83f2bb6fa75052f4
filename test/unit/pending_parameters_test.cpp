// What a roscpp program sees of parameters that it has set in its turn, before the ROS master has
// them. That these are rosmaster's rules is tested of the Python twin.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "roscpp_shim/parameters.h"
#include "roscpp_shim/registrations.h"

namespace move_base_abstract::shim {
namespace {

using XmlRpc::XmlRpcValue;
using Texts = std::vector<std::string>;

XmlRpcValue xml(const std::string& text) {
  int offset = 0;
  return XmlRpcValue("<value>" + text + "</value>", &offset);
}

std::string member(const std::string& name, const std::string& value) {
  return "<member><name>" + name + "</name><value>" + value + "</value></member>";
}

const std::string kOne = "<i4>1</i4>";
const std::string kTwo = "<i4>2</i4>";
const XmlRpcValue kNone;

TEST(PendingParameters, AreSeenByTheirNamesAboveAndBelow) {
  PendingParameters pending;
  pending.set("/a/b", 1);
  EXPECT_TRUE(pending.concern("/a") && pending.concern("/a/b") && pending.concern("/a/b/c"));
  EXPECT_TRUE(pending.concern("/"));
  EXPECT_FALSE(pending.concern("/a/bc") || pending.concern("/b"));
  EXPECT_EQ(pending.seen("/a/b", kNone), XmlRpcValue(1));
  EXPECT_EQ(pending.seen("/a", kNone), xml("<struct>" + member("b", kOne) + "</struct>"));
  EXPECT_EQ(pending.seen("/a", xml("<struct>" + member("c", kTwo) + "</struct>")),
            xml("<struct>" + member("b", kOne) + member("c", kTwo) + "</struct>"));
  EXPECT_FALSE(pending.seen("/a/b/c", xml(kOne)).valid());  // its parent is no tree any more
  EXPECT_EQ(pending.seen("/a", 7), xml("<struct>" + member("b", kOne) + "</struct>"));
}

TEST(PendingParameters, AreTakenInTheirOrder) {
  PendingParameters pending;
  pending.set("/a", xml("<struct>" + member("x", kOne) + member("y", kTwo) + "</struct>"));
  pending.erase("/a/x");
  EXPECT_FALSE(pending.seen("/a/x", 9).valid());
  EXPECT_EQ(pending.seen("/a/y", kNone), XmlRpcValue(2));
  EXPECT_EQ(pending.names({"/a/old", "/b"}), (Texts{"/b", "/a/y"}));
  pending.set("/a/x", 3);
  EXPECT_EQ(pending.seen("/a/x", 9), XmlRpcValue(3));
  pending.erase("/a");
  EXPECT_FALSE(pending.seen("/a", 9).valid());
  pending.clear();
  EXPECT_EQ(pending.seen("/a", 9), XmlRpcValue(9));
}

XmlRpcValue entry(const std::string& name, const Texts& nodes) {
  XmlRpcValue made;
  made[0] = name;
  made[1].setSize(0);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    made[1][static_cast<int>(k)] = nodes[k];
  }
  return made;
}

TEST(Registrations, AreNamedInOneOrderWithoutThoseWhoHaveLeftOrOnlyLookOn) {
  XmlRpcValue state;
  state[0][0] = entry("/z", {"/two", "/one"});
  state[0][1] = entry("/rosout", {"/looker", "/one", "/left", "/map_server"});
  state[0][2] = entry("/map", {"/map_server"});
  state[0][3] = entry("/of_left", {"/left"});
  state[1][0] = entry("/z", {"/looker", "/one"});
  state[1][1] = entry("/only_looked_at", {"/looker"});
  state[2][0] = entry("/looker/get_loggers", {"/looker"});
  const Registrations there(state, {"/one", "/two"}, {"/left"});
  XmlRpcValue wanted;
  wanted[0][0] = entry("/map", {"/map_server"});
  wanted[0][1] = entry("/rosout", {"/map_server", "/one"});
  wanted[0][2] = entry("/z", {"/one", "/two"});
  wanted[1][0] = entry("/z", {"/one"});
  wanted[2].setSize(0);
  EXPECT_EQ(there.state().toXml(), wanted.toXml());
  EXPECT_EQ(there.strangers(), Registrations::Names{"/map_server"});
  XmlRpcValue pairs;
  pairs[0][0] = "/z";
  pairs[0][1] = "t";
  pairs[1][0] = "/of_left";
  pairs[1][1] = "t";
  const XmlRpcValue kept = there.topics(pairs, false);
  EXPECT_EQ(kept.size(), 1);
  EXPECT_EQ(static_cast<std::string>(kept[0][0]), "/z");
  EXPECT_TRUE(there.strangers(kept).empty());
}

}  // namespace
}  // namespace move_base_abstract::shim

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
