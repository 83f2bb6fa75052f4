// Files that participants have opened: one that two of them have, and one at least writes, is a way
// past the order of simulated time. Which files do not matter is decided here, for all programs.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_SHARED_FILES_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_SHARED_FILES_H

#include <map>
#include <set>
#include <string>

#include "lockstep/wire/wire.h"

namespace move_base_abstract {

class SharedFiles {
 public:
  /**
   * @brief A participant has opened a file (kReads or kWrites, by its path
   * without links and dots).
   * @return why the run is not repeatable then; empty: it is.
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

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_SHARED_FILES_H
