// Calls of libraries that cannot be followed, of which each is noted. No ROS.
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/sysinfo.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <sys/times.h>
#include <time.h>
#include <unistd.h>

#include "notices.h"
#include "real.h"
#include "run.h"

namespace move_base_abstract::native {
namespace {

void tell(What what, const void* caller) {
  if (sees(caller) != Sees::kMachine) {
    notice(what, caller);
  }
}

}  // namespace
}  // namespace move_base_abstract::native

namespace native = move_base_abstract::native;

#pragma GCC visibility push(default)
extern "C" {

// ---- the processor and the machine -----------------------------------------------------------

clock_t times(tms* result) {
  static native::Real<clock_t(tms*)> function("times");
  native::tell(native::What::kTimes, MOVE_BASE_ABSTRACT_CALLER);
  return function(result);
}

int getrusage(__rusage_who_t who, rusage* usage) {
  static native::Real<int(__rusage_who_t, rusage*)> function("getrusage");
  native::tell(native::What::kUsage, MOVE_BASE_ABSTRACT_CALLER);
  return function(who, usage);
}

int getloadavg(double loads[], int count) {
  static native::Real<int(double[], int)> function("getloadavg");
  native::tell(native::What::kLoad, MOVE_BASE_ABSTRACT_CALLER);
  return function(loads, count);
}

int sysinfo(struct sysinfo* info) {
  static native::Real<int(struct sysinfo*)> function("sysinfo");
  native::tell(native::What::kSystem, MOVE_BASE_ABSTRACT_CALLER);
  return function(info);
}

pid_t getpid() {
  static native::Real<pid_t()> function("getpid");
  native::tell(native::What::kNumber, MOVE_BASE_ABSTRACT_CALLER);
  return function();
}

// ---- timers of the kernel --------------------------------------------------------------------

int timerfd_create(int clock, int flags) {
  static native::Real<int(int, int)> function("timerfd_create");
  native::tell(native::What::kWakes, MOVE_BASE_ABSTRACT_CALLER);
  return function(clock, flags);
}

int timer_create(clockid_t clock, sigevent* event, timer_t* timer) {
  static native::Real<int(clockid_t, sigevent*, timer_t*)> function("timer_create");
  native::tell(native::What::kWakes, MOVE_BASE_ABSTRACT_CALLER);
  return function(clock, event, timer);
}

int setitimer(__itimer_which_t which, const itimerval* value, itimerval* old) {
  static native::Real<int(__itimer_which_t, const itimerval*, itimerval*)> function("setitimer");
  native::tell(native::What::kWakes, MOVE_BASE_ABSTRACT_CALLER);
  return function(which, value, old);
}

unsigned alarm(unsigned seconds) {
  static native::Real<unsigned(unsigned)> function("alarm");
  native::tell(native::What::kWakes, MOVE_BASE_ABSTRACT_CALLER);
  return function(seconds);
}

useconds_t ualarm(useconds_t value, useconds_t interval) {
  static native::Real<useconds_t(useconds_t, useconds_t)> function("ualarm");
  native::tell(native::What::kWakes, MOVE_BASE_ABSTRACT_CALLER);
  return function(value, interval);
}

// ---- other processes -------------------------------------------------------------------------

FILE* popen(const char* command, const char* how) {
  static native::Real<FILE*(const char*, const char*)> function("popen");
  native::tell(native::What::kProcess, MOVE_BASE_ABSTRACT_CALLER);
  return function(command, how);
}

int system(const char* command) {
  static native::Real<int(const char*)> function("system");
  native::tell(native::What::kProcess, MOVE_BASE_ABSTRACT_CALLER);
  return function(command);
}

pid_t fork() {
  static native::Real<pid_t()> function("fork");
  native::tell(native::What::kProcess, MOVE_BASE_ABSTRACT_CALLER);
  return function();
}

int posix_spawn(pid_t* process, const char* path, const posix_spawn_file_actions_t* actions,
                const posix_spawnattr_t* attributes, char* const arguments[],
                char* const environment[]) {
  static native::Real<int(pid_t*, const char*, const posix_spawn_file_actions_t*,
                          const posix_spawnattr_t*, char* const*, char* const*)>
      function("posix_spawn");
  native::tell(native::What::kProcess, MOVE_BASE_ABSTRACT_CALLER);
  return function(process, path, actions, attributes, arguments, environment);
}

int posix_spawnp(pid_t* process, const char* file, const posix_spawn_file_actions_t* actions,
                 const posix_spawnattr_t* attributes, char* const arguments[],
                 char* const environment[]) {
  static native::Real<int(pid_t*, const char*, const posix_spawn_file_actions_t*,
                          const posix_spawnattr_t*, char* const*, char* const*)>
      function("posix_spawnp");
  native::tell(native::What::kProcess, MOVE_BASE_ABSTRACT_CALLER);
  return function(process, file, actions, attributes, arguments, environment);
}

}  // extern "C"
#pragma GCC visibility pop
