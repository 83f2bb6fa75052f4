#include "time_master/whole_file.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>

using move_base_abstract::wholeFile;

TEST(WholeFile, OfAProcess) {
  const std::string text = wholeFile("/proc/" + std::to_string(getpid()) + "/stat");
  EXPECT_EQ(text.rfind(std::to_string(getpid()) + " (", 0), 0U) << text;
}

TEST(WholeFile, ThatIsNotThere) { EXPECT_EQ(wholeFile("/proc/0/stat"), ""); }

// Opening goes well and reading does not, as with a process that ends in between.
TEST(WholeFile, ThatCanBeOpenedAndNotBeReadIsEmpty) { EXPECT_EQ(wholeFile("/proc"), ""); }

TEST(WholeFile, OfAProcessThatHasBeenOpenedAndHasEnded) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    pause();
    _exit(0);
  }
  const std::string folder = "/proc/" + std::to_string(child);
  ASSERT_EQ(chdir(folder.c_str()), 0);
  kill(child, SIGKILL);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  EXPECT_EQ(wholeFile("stat"), "");
  ASSERT_EQ(chdir("/"), 0);
}
