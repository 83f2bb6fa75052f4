// Who asks: Python itself, or a library that works for the program. No ROS.
#ifndef MOVE_BASE_ABSTRACT_PYTHON_SHIM_CALLERS_H
#define MOVE_BASE_ABSTRACT_PYTHON_SHIM_CALLERS_H

#include <cstddef>

namespace move_base_abstract::native {

/** @return whether the code at an address is the program's, or a library's that works for it: not
 * Python, its modules in C, what these need, and libc. For any thread; it takes no lock of its own.
 */
bool isFollowed(const void* caller);

/** @return whether it is a library's of worker threads: they wait for each other in ways of their
 * own, and what time it is decides nothing. */
bool isWorkerPool(const void* caller);

/** @return the code that @p caller works for: what calls the C++ library. It may allocate. */
const void* beyondWrappers(const void* caller);

/** @brief Write the path of the file that an address lies in, or "". @return where it lies there.
 */
std::size_t placeOf(const void* address, char* path, std::size_t size);

}  // namespace move_base_abstract::native

#endif  // MOVE_BASE_ABSTRACT_PYTHON_SHIM_CALLERS_H
