// The machine's clock for measurements: a system call, which a preloaded library does not replace.
#ifndef MOVE_BASE_ABSTRACT_TEST_MACHINE_TIME_H
#define MOVE_BASE_ABSTRACT_TEST_MACHINE_TIME_H

#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

/** @return the machine's own monotonic time [s]. */
inline double machineTime() {
  timespec now{};
  ::syscall(SYS_clock_gettime, CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

#endif  // MOVE_BASE_ABSTRACT_TEST_MACHINE_TIME_H
