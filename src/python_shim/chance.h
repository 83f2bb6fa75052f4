// The random numbers that libraries see. No ROS.
#ifndef MOVE_BASE_ABSTRACT_PYTHON_SHIM_CHANCE_H
#define MOVE_BASE_ABSTRACT_PYTHON_SHIM_CHANCE_H

namespace move_base_abstract::native {

/** @brief libc's generators start from the seed; a library may have them start from another
 * number. So do the bytes that are drawn instead of the machine's. */
void seedGenerators();

/** @return a descriptor of a file with the run's own random bytes, a MiB of them; -1: @p path is no
 * device of random bytes, or the machine's are to be seen. */
int openEntropy(const char* path, int flags, const void* caller);

}  // namespace move_base_abstract::native

#endif  // MOVE_BASE_ABSTRACT_PYTHON_SHIM_CHANCE_H
