// Which core a run takes. Other runs on this computer may have some meanwhile.
#include "time_master/cores/claimed_core.h"

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

TEST(ClaimedCore, EachRunHasItsOwnWhileThereAreAnyAndThenTheNextOneThatIsFree) {
  const cpu_set_t all = ownCores();
  std::list<ClaimedCore> runs;
  std::set<int> taken;
  do {
    runs.emplace_back().choose(all);
    ASSERT_GE(runs.back().number(), 0);
    EXPECT_TRUE(taken.insert(runs.back().number()).second || runs.back().isShared());
  } while (!runs.back().isShared());
  if (runs.size() == 1) {
    GTEST_SKIP() << "other runs have all cores";
  }
  const int left = runs.front().number();
  runs.front().leave();
  EXPECT_EQ(runs.front().number(), -1);
  runs.back().choose(all);
  EXPECT_EQ(runs.back().number(), left);
  EXPECT_FALSE(runs.back().isShared());
}

}  // namespace
}  // namespace move_base_abstract
