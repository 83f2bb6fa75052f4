// Replaces functions of rosconsole, whose data is shared with roscpp's own threads, which log, too.
#include <fcntl.h>
#include <ros/console.h>
#include <ros/this_node.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/recorder.h"
#include "roscpp_shim/turn.h"

namespace {

constexpr std::size_t kLongest = 1000;  // bytes of a text

/** Notes an ERROR or FATAL line of a thread with the turn, as runs/error_lines.py does. */
void note(ros::console::Level level, const char* text) {
  const char* const folder = std::getenv(shim::kNotesVariable);
  const shim::Task* const task = shim::Turn::self();
  if (folder == nullptr || level < ros::console::levels::Error || !shim::turn().isActive() ||
      task == nullptr || task->is_loose || shim::Turn::isInside()) {
    return;
  }
  const shim::Inside inside;
  std::string name = ros::this_node::getName();
  std::replace(name.begin(), name.end(), '/', '.');
  const std::string path = std::string(folder) + "/errors" + name;
  std::string line(1, level == ros::console::levels::Fatal ? 'F' : 'E');
  int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file >= 0) {
    line = std::string(text).substr(0, kLongest) + '\0' + line;
  } else {
    file = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  }
  if (file >= 0) {
    [[maybe_unused]] const ssize_t written = ::write(file, line.data(), line.size());
    ::close(file);
  }
}

}  // namespace

namespace ros::console {

ROSCONSOLE_DECL void initializeLogLocation(LogLocation* location, const std::string& name,
                                           Level level) {
  static auto* const function =
      shim::real(&initializeLogLocation, "ros::console::initializeLogLocation");
  const shim::Beside beside;
  function(location, name, level);
}

namespace impl {

ROSCONSOLE_DECL void print(void* handle, Level level, const char* text, const char* file,
                           const char* caller, int line) {
  static auto* const function = shim::real(&print, "ros::console::impl::print");
  const shim::Beside beside;
  note(level, text);
  function(handle, level, text, file, caller, line);
}

}  // namespace impl

}  // namespace ros::console
