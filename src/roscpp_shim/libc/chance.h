// Files of random bytes (/dev/urandom, /dev/random), as the program sees them.
#pragma once

namespace move_base_abstract::shim {

/** @return the descriptor of a file with 1 MiB of random bytes that follow from the run's seed; -1
 * if @p path is no device of random bytes, or if the program is to see the machine's. */
int openEntropy(const char* path, int flags, const void* caller);

}  // namespace move_base_abstract::shim
