// The secret of a run: where it is read from, and what is refused.
#include "common/run_secret.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>

namespace move_base_abstract {
namespace {

/** @brief A file that only its owner may use. */
class SecretFile {
 public:
  explicit SecretFile(const std::string& content, mode_t mode = 0600) {
    close(mkstemp(path_));
    std::ofstream(path_) << content;
    chmod(path_, mode);
  }
  ~SecretFile() { unlink(path_); }
  std::string path() const { return path_; }

 private:
  char path_[32] = "/tmp/run_secret_XXXXXX";
};

std::string refused(const std::string& text, const std::string& file) {
  try {
    runSecret(text, file);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(RunSecret, IsATextOrWhatAFileHasWithoutSpaceAround) {
  EXPECT_EQ(runSecret("", ""), "");
  EXPECT_EQ(runSecret(" abc\n", ""), "abc");
  EXPECT_EQ(runSecret("", SecretFile(" a b\xff\r\n").path()), "a b\xff");
  const std::string longest(kLongestSecret, 'x');
  EXPECT_EQ(runSecret("", SecretFile(longest + "\n").path()), longest);
}

TEST(RunSecret, FilesThatOthersMayUseAreRefused) {
  for (const mode_t mode : {0640, 0604, 0620, 0601}) {
    const SecretFile file("abc", mode);
    EXPECT_EQ(refused("", file.path()),
              "lockstep_secret_file must be a file that only its owner can read, got '" +
                  file.path() + "': others may use it too; chmod 600 changes that");
  }
}

TEST(RunSecret, WhatIsNoneIsRefused) {
  EXPECT_NE(refused("a", "b").find("must not be set both"), std::string::npos);
  EXPECT_EQ(refused(" ", ""), "lockstep_secret must have from 1 to 1024 bytes, got none");
  EXPECT_NE(refused(std::string(1025, 'x'), "").find("got more"), std::string::npos);
  EXPECT_NE(refused("", "/none").find("No such file"), std::string::npos);
  EXPECT_NE(refused("", "/tmp").find("no ordinary file"), std::string::npos);
  EXPECT_NE(refused("", SecretFile(" \n").path()).find("got none"), std::string::npos);
  EXPECT_NE(refused("", SecretFile(std::string(1025, 'x')).path()).find("got more"),
            std::string::npos);
}

}  // namespace
}  // namespace move_base_abstract
