// Whether the addresses of the program's memory are the same in each run.
#pragma once

#include <string>

namespace move_base_abstract::shim {

/** @return why the addresses of the program's memory may differ from run to run; empty: they do
 * not. */
std::string whyAddressesDiffer();

/** @return whether the heap was full, or handed out blocks again that were freed without order. */
bool areAddressesMixed();

}  // namespace move_base_abstract::shim
