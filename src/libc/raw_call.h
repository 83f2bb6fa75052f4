// libc's syscall(), which both preloaded libraries stand in front of. No ROS.
#pragma once

#pragma GCC visibility push(default)
/** @brief syscall(), whose words come where those of any other function come, however many its
 * caller gives. Those that it does not give are left over, and the kernel does not look at them. */
extern "C" long rawCall(long number, long a, long b, long c, long d, long e, long f) noexcept
    __asm__("syscall");
#pragma GCC visibility pop
