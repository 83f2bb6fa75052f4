// Whether this library fits the program that it is preloaded into. No ROS.
#pragma once

#include <string>
#include <vector>

namespace move_base_abstract::shim {

/** @brief The libraries that were found in the program. */
struct Surroundings {
  std::string glibc;                 // version, such as "2.36"
  std::vector<std::string> roscpp;   // paths of all libroscpp.so that are loaded
  std::string roscpp_version;        // such as "1.15.15"; empty: not known
  std::vector<std::string> missing;  // names of functions that the program's libraries do not have
  bool has_owners = false;           // glibc's locks name their holder in the expected field
  bool has_clocks = false;           // glibc's conditions name their clock in the expected field
};

/** @return the Surroundings of this process. */
Surroundings lookAround();

/** @return why the library does not fit, with what was found and what is allowed; empty: it fits.
 */
std::string misfit(const Surroundings& found);

/** @return the versions that the library fits, in words. */
std::string fitting();

/** @return the version of a library, from its path or from its package's package.xml; empty: not
 * known. */
std::string versionOf(const std::string& path, const std::string& package);

}  // namespace move_base_abstract::shim
