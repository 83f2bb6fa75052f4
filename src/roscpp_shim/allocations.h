// Where the program's memory comes from.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_ALLOCATIONS_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_ALLOCATIONS_H

#include <string>

namespace move_base_abstract::shim {

/** @return why the addresses of what the program allocates may differ from run to run; empty: they
 * do not. */
std::string whyAddressesDiffer();

/** @return whether blocks have come back in no order, and more of them than could be put by. */
bool areAddressesMixed();

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_ALLOCATIONS_H
