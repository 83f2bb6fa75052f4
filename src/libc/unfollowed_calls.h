// Calls that no preloaded library follows: they start processes that take no part, or show how busy
// the machine is. The one source that includes this has `policy`, a namespace with Real<Function>,
//   void tellUse(What, const void* caller);       // the What: kTimes, kUsage, kLoad, kSystem
//   class Start { Start(const char* name, const void* caller); void goOnIn(pid_t process); };
// which lives as long as a process is being started. No ROS.
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/sysinfo.h>
#include <sys/times.h>
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
