// Reads a file of the kernel, such as in /proc, which may vanish meanwhile.
#pragma once

#include <fstream>
#include <string>

namespace move_base_abstract {

/** @return the content of a file without zero bytes; '' if it cannot be read, or not any more. */
inline std::string wholeFile(const std::string& path) {
  std::ifstream file(path);
  std::string text;
  // Not with an iterator, which throws if the process behind a file of /proc ends meanwhile.
  std::getline(file, text, '\0');
  return text;
}

}  // namespace move_base_abstract
