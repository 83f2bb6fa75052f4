// Files that participants have opened, and which of them label a run.
#include <gtest/gtest.h>

#include <string>

#include "lockstep/shared_files.h"

namespace move_base_abstract::lockstep_files_test {
namespace {

constexpr auto kReads = wire::NoteKind::kReads;
constexpr auto kWrites = wire::NoteKind::kWrites;

/** @return whether it labels the run that one participant reads what another one writes. */
bool matters(const std::string& path) {
  SharedFiles files;
  files.add("/a", {kWrites, path});
  return !files.add("/b", {kReads, path}).empty();
}

TEST(SharedFiles, OneThatTwoHaveAndOneWritesLabelsTheRun) {
  SharedFiles files;
  EXPECT_EQ(files.add("/a", {kReads, "/home/map"}), "");
  EXPECT_EQ(files.add("/b", {kReads, "/home/map"}), "");
  EXPECT_EQ(files.add("/a", {kWrites, "/home/own"}), "");
  EXPECT_EQ(files.add("/a", {kReads, "/home/own"}), "");
  EXPECT_EQ(files.add("/b", {kWrites, "/home/map"}),
            "'/b' writes /home/map, which '/a' reads: data that passes between them is not in the "
            "order of simulated time");
  EXPECT_EQ(files.add("/c", {kReads, "/home/map"}),
            "'/c' reads /home/map, which '/b' writes: data that passes between them is not in the "
            "order of simulated time");
}

TEST(SharedFiles, WhatIsTheSameForAllOrIsToldOfInAnotherWayDoesNot) {
  for (const char* path : {"/tmp/x", "/library/x", "/dev/shm/x", "/home/usr/x", "/home/dev/null",
                           "/home/my_rospack_cache_1", "/home/__pycache__", "x"}) {
    EXPECT_TRUE(matters(path)) << path;
  }
  for (const char* path :
       {"/usr/share/x", "/lib/x", "/lib64/x", "/etc/x", "/opt/ros/x", "/proc/stat", "/sys/x",
        "/dev/null", "/dev/shmx", "/home/me/.ros/rospack_cache_08", "rosstack_cache_08",
        "/home/me/__pycache__/solve.nbi"}) {
    EXPECT_FALSE(matters(path)) << path;
  }
}

}  // namespace
}  // namespace move_base_abstract::lockstep_files_test
