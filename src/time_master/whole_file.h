// A file of the kernel's, which may vanish while it is read.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_WHOLE_FILE_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_WHOLE_FILE_H

#include <fstream>
#include <string>

namespace move_base_abstract {

/** @return what a file without zeros holds; '' if it cannot be read, or no more. */
inline std::string wholeFile(const std::string& path) {
  std::ifstream file(path);
  std::string text;
  // Not by an iterator: it throws if the process that a file of /proc is about ends meanwhile.
  std::getline(file, text, '\0');
  return text;
}

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_WHOLE_FILE_H
