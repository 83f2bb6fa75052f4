// What the kernel knows about this process.
#pragma once

#include <string>

#include "libc/ask_kernel.h"

namespace move_base_abstract::shim {

/** @return what a descriptor leads to, such as "pipe:[4711]", "/dev/ttyUSB0" or
 * "anon_inode:[timerfd]"; "": not known. */
std::string targetOf(int descriptor);

/** @return the first line of a file in which the kernel describes a thread of this process. */
std::string lineOf(const std::string& tid, const char* file);

/** @return the state of a thread: 'S' if it sleeps in the kernel, 'R' if it runs; 0: it has gone.
 */
char stateOf(const std::string& tid);

/** @return whether a thread waits because the output of this process is not being read. */
bool waitsForReader();

}  // namespace move_base_abstract::shim
