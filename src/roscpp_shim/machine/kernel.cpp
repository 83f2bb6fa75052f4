#include "kernel.h"

#include <dirent.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>

namespace move_base_abstract::shim {
std::string targetOf(int descriptor) {
  std::array<char, 256> target{};
  const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
  const auto length = ::readlink(path.c_str(), target.data(), target.size());
  return {target.data(), static_cast<std::size_t>(std::max<ssize_t>(length, 0))};
}

std::string lineOf(const std::string& tid, const char* file) {
  std::ifstream stream("/proc/self/task/" + tid + "/" + file);
  std::string line;
  std::getline(stream, line);
  return line;
}

char stateOf(const std::string& tid) {
  const std::string stat = lineOf(tid, "stat");
  const auto name_end = stat.rfind(')');
  return name_end == std::string::npos || name_end + 2 >= stat.size() ? '\0' : stat[name_end + 2];
}

bool waitsForReader() {
  std::unique_ptr<DIR, int (*)(DIR*)> tasks(::opendir("/proc/self/task"), &::closedir);
  while (const dirent* const entry = tasks ? ::readdir(tasks.get()) : nullptr) {
    std::istringstream call(lineOf(entry->d_name, "syscall"));
    std::uint64_t number = 0;
    int descriptor = 0;
    if (call >> number >> std::hex >> descriptor && (number == SYS_write || number == SYS_writev)) {
      const std::string target = targetOf(descriptor);
      if (target == targetOf(STDOUT_FILENO) || target == targetOf(STDERR_FILENO)) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace move_base_abstract::shim
