// Files that participants have opened. If two participants use one file, and at least one writes
// it, data can pass between them outside the order of simulated time. For programs of all kinds,
// shared_files.cpp decides which files do not matter.
#pragma once

#include <map>
#include <set>
#include <string>

#include "lockstep/wire/wire.h"

namespace move_base_abstract {

class SharedFiles {
 public:
  /**
   * @brief Note that a participant has opened a file. @param note kReads or kWrites, with the path
   * without links and dots.
   * @return the reason why the run is not repeatable then; '' if it is.
   */
  std::string add(const std::string& member, const wire::Note& note);

 private:
  struct File {
    std::set<std::string> writers;
    std::set<std::string> readers;
  };
  std::map<std::string, File> files_;
};

}  // namespace move_base_abstract
