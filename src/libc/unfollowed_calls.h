// Calls that no preloaded library follows: they start processes that take no part, have the kernel
// wake the program by the wall clock, or show how busy the machine is. The one source that includes
// this has `policy`, a namespace with Real<Function>,
//   void tellUse(What, const void* caller);       // the What: kTimes, kUsage, kLoad, kSystem
//   void tellTimer(const char* name, const void* caller);
//   class Start { Start(const char* name, const void* caller); void goOnIn(pid_t process); };
// which lives as long as a process is being started. No ROS.
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/sysinfo.h>
#include <sys/time.h>
#include <sys/times.h>
#include <time.h>
#include <unistd.h>

#include "looked_up.h"

namespace move_base_abstract::shim {

using Spawn = int(pid_t*, const char*, const posix_spawn_file_actions_t*, const posix_spawnattr_t*,
                  char* const[], char* const[]);

}  // namespace move_base_abstract::shim

#pragma GCC visibility push(default)
extern "C" {

// ---- processes -------------------------------------------------------------------------------

FILE* popen(const char* command, const char* how) {
  static policy::Real<FILE*(const char*, const char*)> function("popen");
  const policy::Start start("popen()", MOVE_BASE_ABSTRACT_CALLER);
  return function(command, how);
}

int system(const char* command) {
  static policy::Real<int(const char*)> function("system");
  const policy::Start start("system()", MOVE_BASE_ABSTRACT_CALLER);
  return function(command);
}

pid_t fork() {
  static policy::Real<pid_t()> function("fork");
  policy::Start start("fork()", MOVE_BASE_ABSTRACT_CALLER);
  const pid_t child = function();
  start.goOnIn(child);
  return child;
}

int posix_spawn(pid_t* process, const char* path, const posix_spawn_file_actions_t* actions,
                const posix_spawnattr_t* attributes, char* const arguments[],
                char* const environment[]) {
  static policy::Real<move_base_abstract::shim::Spawn> function("posix_spawn");
  const policy::Start start("posix_spawn()", MOVE_BASE_ABSTRACT_CALLER);
  return function(process, path, actions, attributes, arguments, environment);
}

int posix_spawnp(pid_t* process, const char* file, const posix_spawn_file_actions_t* actions,
                 const posix_spawnattr_t* attributes, char* const arguments[],
                 char* const environment[]) {
  static policy::Real<move_base_abstract::shim::Spawn> function("posix_spawnp");
  const policy::Start start("posix_spawnp()", MOVE_BASE_ABSTRACT_CALLER);
  return function(process, file, actions, attributes, arguments, environment);
}

// ---- timers of the kernel --------------------------------------------------------------------

int timer_create(clockid_t clock, sigevent* event, timer_t* timer) {
  static policy::Real<int(clockid_t, sigevent*, timer_t*)> function("timer_create");
  policy::tellTimer("timer_create()", MOVE_BASE_ABSTRACT_CALLER);
  return function(clock, event, timer);
}

int setitimer(__itimer_which_t which, const itimerval* value, itimerval* old) {
  static policy::Real<int(__itimer_which_t, const itimerval*, itimerval*)> function("setitimer");
  policy::tellTimer("setitimer()", MOVE_BASE_ABSTRACT_CALLER);
  return function(which, value, old);
}

unsigned alarm(unsigned seconds) {
  static policy::Real<unsigned(unsigned)> function("alarm");
  policy::tellTimer("alarm()", MOVE_BASE_ABSTRACT_CALLER);
  return function(seconds);
}

useconds_t ualarm(useconds_t value, useconds_t interval) {
  static policy::Real<useconds_t(useconds_t, useconds_t)> function("ualarm");
  policy::tellTimer("ualarm()", MOVE_BASE_ABSTRACT_CALLER);
  return function(value, interval);
}

// ---- the processor and the machine -----------------------------------------------------------

clock_t times(tms* result) {
  static policy::Real<clock_t(tms*)> function("times");
  policy::tellUse(policy::kTimes, MOVE_BASE_ABSTRACT_CALLER);
  return function(result);
}

int getrusage(__rusage_who_t who, rusage* usage) {
  static policy::Real<int(__rusage_who_t, rusage*)> function("getrusage");
  policy::tellUse(policy::kUsage, MOVE_BASE_ABSTRACT_CALLER);
  return function(who, usage);
}

int getloadavg(double loads[], int count) {
  static policy::Real<int(double[], int)> function("getloadavg");
  policy::tellUse(policy::kLoad, MOVE_BASE_ABSTRACT_CALLER);
  return function(loads, count);
}

int sysinfo(struct sysinfo* info) {
  static policy::Real<int(struct sysinfo*)> function("sysinfo");
  policy::tellUse(policy::kSystem, MOVE_BASE_ABSTRACT_CALLER);
  return function(info);
}

}  // extern "C"
#pragma GCC visibility pop
