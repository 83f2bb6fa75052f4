// Which cores a run takes. Other runs on this computer may have some meanwhile.
#include "time_master/cores/claimed_cores.h"

#include <gtest/gtest.h>

#include <list>
#include <set>

namespace move_base_abstract {
namespace {

cpu_set_t ownCores() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  sched_getaffinity(0, sizeof cores, &cores);
  return cores;
}

TEST(ClaimedCores, EachRunHasItsOwnWhileThereAreAnyAndThenTheNextOneThatIsFree) {
  const cpu_set_t all = ownCores();
  std::list<ClaimedCores> runs;
  std::set<int> taken;
  do {
    runs.emplace_back().choose(all, 1, 1);
    ASSERT_EQ(runs.back().numbers().size(), 1U);
    EXPECT_TRUE(taken.insert(runs.back().numbers().front()).second || runs.back().areShared());
  } while (!runs.back().areShared());
  if (runs.size() == 1) {
    GTEST_SKIP() << "other runs have all cores";
  }
  const std::vector<int> left = runs.front().numbers();
  runs.front().leave();
  EXPECT_TRUE(runs.front().numbers().empty());
  runs.back().choose(all, 1, 1);
  EXPECT_EQ(runs.back().numbers(), left);
  EXPECT_FALSE(runs.back().areShared());
}

TEST(ClaimedCores, ARunThatNeedsTwoSharesThemIfThereAreNoOthers) {
  const cpu_set_t all = ownCores();
  const auto many = static_cast<std::size_t>(CPU_COUNT(&all));
  ClaimedCores first;
  ClaimedCores second;
  first.choose(all, 1, many);
  second.choose(all, 2, many);
  EXPECT_EQ(second.numbers().size(), many);
  EXPECT_TRUE(second.areShared());
  EXPECT_TRUE(second.areIn(all));
}

}  // namespace
}  // namespace move_base_abstract
