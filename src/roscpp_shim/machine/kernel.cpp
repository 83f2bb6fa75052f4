#include "kernel.h"

#include <dirent.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string>

namespace move_base_abstract::shim {
namespace {

/** @return the target of a descriptor of this process, for example "pipe:[4711]". */
std::string targetOf(std::uint64_t file) {
  std::array<char, 256> target{};
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  const auto length = ::readlink(path.c_str(), target.data(), target.size());
  return {target.data(), static_cast<std::size_t>(std::max<ssize_t>(length, 0))};
}

}  // namespace

bool isAsleep(int tid) {
  std::ifstream file("/proc/self/task/" + std::to_string(tid) + "/stat");
  std::string text;
  std::getline(file, text);
  const auto name_end = text.rfind(')');
  return name_end != std::string::npos && name_end + 2 < text.size() && text[name_end + 2] == 'S';
}

bool waitsForReader() {
  std::unique_ptr<DIR, int (*)(DIR*)> tasks(::opendir("/proc/self/task"), &::closedir);
  while (const dirent* const entry = tasks ? ::readdir(tasks.get()) : nullptr) {
    std::ifstream file("/proc/self/task/" + std::string(entry->d_name) + "/syscall");
    std::uint64_t number = 0;
    std::uint64_t descriptor = 0;
    if (file >> number >> std::hex >> descriptor && (number == SYS_write || number == SYS_writev)) {
      const std::string target = targetOf(descriptor);
      if (target == targetOf(STDOUT_FILENO) || target == targetOf(STDERR_FILENO)) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace move_base_abstract::shim
