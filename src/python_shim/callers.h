// Which code calls: Python itself, or a library that works for the program. No ROS.
#pragma once

#include <cstddef>

namespace move_base_abstract::native {

/** @return whether the code at an address belongs to the program, or to a library that works for
 * it, and not to Python, its modules in C, libraries that only these need, or libc. For any thread;
 * it takes no lock of its own. */
bool isFollowed(const void* caller);

/** @return whether the code belongs to a library of worker threads. These wait for each other in
 * their own ways, and the time that they read decides nothing. */
bool isWorkerPool(const void* caller);

/** @return the code for which @p caller works: if that is the C++ library, Boost or a pool
 * of workers, the code that called it. This may allocate. */
const void* beyondWrappers(const void* caller);

/** @brief Write into @p path the path of the file in which an address lies, or "".
 * @return the offset in the file. */
std::size_t placeOf(const void* address, char* path, std::size_t size);

}  // namespace move_base_abstract::native
