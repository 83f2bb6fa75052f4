// Files of the machine's random bytes, as the program sees them.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_LIBC_CHANCE_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_LIBC_CHANCE_H

namespace move_base_abstract::shim {

/** @return a descriptor of a file with the run's own random bytes, a MiB of them; -1: @p path is no
 * device of random bytes, or the machine's are to be seen. */
int openEntropy(const char* path, int flags, const void* caller);

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_LIBC_CHANCE_H
