#include "time_master/whole_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

using move_base_abstract::wholeFile;

TEST(WholeFile, OfAProcess) {
  const std::string text = wholeFile("/proc/" + std::to_string(getpid()) + "/stat");
  EXPECT_EQ(text.rfind(std::to_string(getpid()) + " (", 0), 0U) << text;
}

TEST(WholeFile, ThatIsNotThere) { EXPECT_EQ(wholeFile("/proc/0/stat"), ""); }

// Opening goes well and reading does not, as with a process that ends in between.
TEST(WholeFile, ThatCanBeOpenedAndNotBeReadIsEmpty) { EXPECT_EQ(wholeFile("/proc"), ""); }
