// What the kernel says of this process's threads.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_KERNEL_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_KERNEL_H

namespace move_base_abstract::shim {

/** @return whether the thread sleeps in the kernel (and is not just being slow). */
bool isAsleep(int tid);

/** @return whether a thread waits for somebody to read what this process prints. */
bool waitsForReader();

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_KERNEL_H
