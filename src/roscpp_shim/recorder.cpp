#include "recorder.h"

#include <fcntl.h>
#include <ros/this_node.h>
#include <unistd.h>

#include <atomic>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

#include "followed.h"
#include "turn.h"

namespace move_base_abstract::shim {
namespace {

std::atomic<bool> records{false};

/** @return whether the command line has the option --duration, which may be shortened. */
bool hasDuration() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  const std::string words{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  return words.find(std::string(1, '\0') + "--d") != std::string::npos;
}

/** @return whether the program is rosbag's own recorder, not one that also does other things. */
bool isRecorder() {
  static const bool is_one = [] {
    return std::strcmp(program_invocation_short_name, "record") == 0 && !hasDuration();
  }();
  return is_one;
}

std::string absolute(const char* path) {
  char folder[PATH_MAX];
  const bool is_absolute = *path == '/' || ::getcwd(folder, sizeof folder) == nullptr;
  return is_absolute ? path : std::string(folder) + "/" + path;
}

}  // namespace

bool isRecordersLook(const void* caller) {
  if (!isRecorder() || !isIn(caller, {"/librosbag.so"})) {
    return false;
  }
  records = true;
  return true;
}

bool onlyRecords() { return records; }

void noteBag(const char* path, const char* how, const void* caller) {
  const char* const folder = std::getenv(kNotesVariable);
  if (folder == nullptr || path == nullptr || std::strpbrk(how, "wa+") == nullptr ||
      !isIn(caller, {"/librosbag_storage.so"})) {
    return;
  }
  const Inside inside;
  const std::string line = ros::this_node::getName() + '\0' + absolute(path) + '\0';
  const std::string notes = std::string(folder) + "/bags";
  const int file = ::open(notes.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (file >= 0) {
    // If this fails, the bag is not noted, and so not called covered.
    [[maybe_unused]] const ssize_t written = ::write(file, line.data(), line.size());
    ::close(file);
  }
}

}  // namespace move_base_abstract::shim
