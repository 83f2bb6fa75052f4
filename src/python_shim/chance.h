// The random numbers that libraries see. No ROS.
#ifndef MOVE_BASE_ABSTRACT_PYTHON_SHIM_CHANCE_H
#define MOVE_BASE_ABSTRACT_PYTHON_SHIM_CHANCE_H

namespace move_base_abstract::native {

/** @brief Start libc's generators, and the bytes that replace the machine's, from the seed. A
 * library may start libc's generators again from another number. */
void seedGenerators();

/** @return a descriptor of a file with 1 MiB of the run's own random bytes; -1 if @p path is not a
 * device of random bytes, or the caller sees the machine's. */
int openEntropy(const char* path, int flags, const void* caller);

}  // namespace move_base_abstract::native

#endif  // MOVE_BASE_ABSTRACT_PYTHON_SHIM_CHANCE_H
