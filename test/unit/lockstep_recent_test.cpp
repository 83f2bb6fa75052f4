// Messages that the time master keeps, for those who look at a run in a debugger.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "lockstep_client.h"

namespace move_base_abstract::lockstep_recent_test {
namespace {

TEST(Kept, TheLatestMessagesOfEachTopicAndServiceAreThereWithTheirBytes) {
  LockstepSettings settings = named({"/a", "/b"});
  settings.keep_messages = 2;
  Pair pair(settings);
  pair.report(1, 2 * kSecond, {advertise(1, "/t"), advertise(2, "/other")});
  pair.report(2, kNever, {subscribe(1, "/t"), subscribe(2, "/other"), wire::Serve{1, 0, "/s"}});
  pair.grant(1);
  pair.grant(2);
  pair.report(1, 2 * kSecond);
  pair.report(2, kNever);
  pair.grant(1);
  pair.report(1, 3 * kSecond,
              {wire::Send{1, 0, 0, "1"}, wire::Send{2, 0, 0, "2"}, wire::Send{1, 0, 0, "3"},
               wire::Send{1, 0, 0, "4"}, wire::Call{0, 0, "/s", "5"}});
  const auto texts = [&](const std::string& name, const std::string& node, std::size_t most) {
    std::string all;
    for (const KeptMessages::One& one : pair.session.recent(name, node, most)) {
      all += one.bytes;
    }
    return all;
  };
  EXPECT_EQ(texts("", "", 0), "2345");
  EXPECT_EQ(texts("", "/b", 3), "345");
  EXPECT_EQ(texts("/t", "", 0), "34");
  EXPECT_EQ(texts("", "/c", 0), "");
  const KeptMessages::One first = pair.session.recent("/t", "/a", 1).front();
  EXPECT_EQ(first.time, 2 * kSecond);
  EXPECT_EQ(first.kind + first.type + first.md5 + first.sender, "messagetest/Typemd5/a");
  EXPECT_EQ(first.receivers, std::vector<std::string>{"/b"});
}

TEST(Kept, AsManyBytesAsFitAndTheLatestMessageAlways) {
  KeptMessages kept(100);
  for (const char letter : {'a', 'b', 'c'}) {
    kept.add({0, "message", "/t", "", "", "/a", {}, std::string(9U << 20, letter)});
  }
  kept.add({0, "message", "/small", "", "", "/a", {}, "d"});
  ASSERT_EQ(kept.recent("", "", 0).size(), 2U);
  EXPECT_EQ(kept.recent("", "", 0).front().bytes.front(), 'c');
}

TEST(Kept, NothingUnlessItWasAskedFor) {
  Pair pair;
  EXPECT_EQ(refusal([&] { pair.session.recent("", "", 0); }).substr(0, 28),
            "recent: no messages are kept");
}

}  // namespace
}  // namespace move_base_abstract::lockstep_recent_test
