// Files that a run leaves for other programs. Each appears when it is whole, and replaces no other.
// No ROS.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>

namespace move_base_abstract {

/**
 * @brief Write a new file, under the name PATH.part until it is whole.
 * @return why @p path was not written, as "@p what @p path: reason"; '' if it was.
 */
inline std::string writeNewFile(const std::string& what, const std::string& path,
                                std::string_view text) {
  const std::string part = path + ".part";
  std::FILE* const file = std::fopen(part.c_str(), "wxe");
  bool good = file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  good = (file == nullptr || std::fclose(file) == 0) && good;
  good = good && link(part.c_str(), path.c_str()) == 0;  // rename() would replace an existing file
  const int error = errno;
  if (file != nullptr) {
    unlink(part.c_str());
  }
  return good ? "" : what + " " + path + ": " + std::strerror(error);
}

}  // namespace move_base_abstract
