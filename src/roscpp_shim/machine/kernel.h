// What the kernel knows about the threads of this process.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_KERNEL_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_KERNEL_H

namespace move_base_abstract::shim {

/** @return whether the thread sleeps in the kernel (and is not just slow). */
bool isAsleep(int tid);

/** @return whether a thread waits because the output of this process is not being read. */
bool waitsForReader();

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_KERNEL_H
