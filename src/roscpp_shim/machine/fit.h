// Whether this library fits the program that it is preloaded into. No ROS.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_FIT_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_FIT_H

#include <string>
#include <vector>

namespace move_base_abstract::shim {

/** @brief A row of replaced.def. */
struct Replaced {
  const char* library;  // "roscpp", "rostime", "libc", "libstdc++"
  const char* since;    // its first version of which the function is as expected
  const char* name;
  const char* symbol;  // as the linker knows it
};

/** @return the table. */
const std::vector<Replaced>& replacedFunctions();

/** @brief What was found in the program. */
struct Surroundings {
  std::string glibc;                 // version, "2.36"
  std::vector<std::string> roscpp;   // paths of all libroscpp.so that are loaded
  std::string roscpp_version;        // "1.15.15"; empty: not known
  std::vector<std::string> missing;  // names of functions that the program's libraries do not have
  bool has_owners = false;           // glibc's locks say who holds them, where it is looked up
  bool has_clocks = false;           // its conditions say by which clock they wait
};

/** @return what is so in this process. */
Surroundings lookAround();

/** @return why the library does not fit, with what was got and what is allowed; empty: it does. */
std::string misfit(const Surroundings& found);

/** @return what it fits, in words. */
std::string fitting();

/** @return the version of a library from its path, or from the package that it is a part of. */
std::string versionOf(const std::string& path, const std::string& package);

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_FIT_H
