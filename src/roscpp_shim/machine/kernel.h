// What the kernel knows about this process.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_KERNEL_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_KERNEL_H

#include <string>

namespace move_base_abstract::shim {

/** @return what the kernel answers to a system call, past all that stands in front of libc, and
 * without an allocation; a number of -4095 to -1 is an error. */
inline long askKernel(long number, long a = 0, long b = 0, long c = 0, long d = 0, long e = 0,
                      long f = 0) {
#if defined(__x86_64__)
  register long fourth asm("r10") = d;
  register long fifth asm("r8") = e;
  register long sixth asm("r9") = f;
  long answer = number;
  asm volatile("syscall"
               : "+a"(answer)
               : "D"(a), "S"(b), "d"(c), "r"(fourth), "r"(fifth), "r"(sixth)
               : "rcx", "r11", "memory");
#else
  register long which asm("x8") = number;
  register long answer asm("x0") = a;
  register long second asm("x1") = b;
  register long third asm("x2") = c;
  register long fourth asm("x3") = d;
  register long fifth asm("x4") = e;
  register long sixth asm("x5") = f;
  asm volatile("svc 0"
               : "+r"(answer)
               : "r"(which), "r"(second), "r"(third), "r"(fourth), "r"(fifth), "r"(sixth)
               : "memory");
#endif
  return answer;
}

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

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_KERNEL_H
