// What is shared with processes that take no part, or started as one: that is told.
#include <netinet/in.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/sysinfo.h>
#include <unistd.h>

#include <string>

#include "cores.h"
#include "followed.h"
#include "parameters.h"
#include "real.h"
#include "turn.h"

namespace move_base_abstract::shim {
namespace {

/** @brief The program, or a library that works for it, does @p what; roscpp's own doing is not
 * told. */
void tellUse(const char* what, const void* caller) {
  if (!Turn::isInside() && !Turn::isInternal() && sees() != Sees::kMachine && !isRoscpps(caller)) {
    tell(what, caller);
  }
}

/** @brief Another process takes no part. */
void tellProcess(const std::string& name, const void* caller) {
  tellUse((name + " starts a process that takes no part: what it answers is the machine's").c_str(),
          caller);
  parameters().settle();
}

/** @brief Memory that other processes have too. Libraries of the system share what is nobody's
 * business. */
void tellShared(const std::string& name, const void* caller) {
  if (!Turn::isInside() && !Turn::isInternal() && sees() != Sees::kMachine &&
      isProgramsOwn(caller)) {
    tell(name + " shares memory with other processes: what they write comes when it comes", caller);
  }
}

void tellMapped(int flags, int file, const void* caller) {
  if ((flags & MAP_SHARED) != 0 && file >= 0) {
    tellShared("mmap()", caller);
  }
}

}  // namespace
}  // namespace move_base_abstract::shim

namespace shim = move_base_abstract::shim;

#pragma GCC visibility push(default)
extern "C" {

// ---- processes -------------------------------------------------------------------------------

FILE* popen(const char* command, const char* how) {
  static auto* const function = shim::real<FILE*(const char*, const char*)>("popen");
  shim::tellProcess("popen()", MOVE_BASE_ABSTRACT_CALLER);
  const shim::OwnCores cores;
  return function(command, how);
}

int system(const char* command) {
  static auto* const function = shim::real<int(const char*)>("system");
  shim::tellProcess("system()", MOVE_BASE_ABSTRACT_CALLER);
  const shim::OwnCores cores;
  return function(command);
}

pid_t fork() {
  static auto* const function = shim::real<pid_t()>("fork");
  shim::tellProcess("fork()", MOVE_BASE_ABSTRACT_CALLER);
  shim::OwnCores cores;
  const pid_t child = function();
  if (child == 0) {
    cores.keep();
  }
  return child;
}

int posix_spawn(pid_t* process, const char* path, const posix_spawn_file_actions_t* actions,
                const posix_spawnattr_t* attributes, char* const arguments[],
                char* const environment[]) {
  using Spawn = int(pid_t*, const char*, const posix_spawn_file_actions_t*,
                    const posix_spawnattr_t*, char* const[], char* const[]);
  static auto* const function = shim::real<Spawn>("posix_spawn");
  shim::tellProcess("posix_spawn()", MOVE_BASE_ABSTRACT_CALLER);
  const shim::OwnCores cores;
  return function(process, path, actions, attributes, arguments, environment);
}

int posix_spawnp(pid_t* process, const char* file, const posix_spawn_file_actions_t* actions,
                 const posix_spawnattr_t* attributes, char* const arguments[],
                 char* const environment[]) {
  using Spawn = int(pid_t*, const char*, const posix_spawn_file_actions_t*,
                    const posix_spawnattr_t*, char* const[], char* const[]);
  static auto* const function = shim::real<Spawn>("posix_spawnp");
  shim::tellProcess("posix_spawnp()", MOVE_BASE_ABSTRACT_CALLER);
  const shim::OwnCores cores;
  return function(process, file, actions, attributes, arguments, environment);
}

// ---- connections -----------------------------------------------------------------------------

int socket(int domain, int type, int protocol) {
  static auto* const function = shim::real<int(int, int, int)>("socket");
  if (domain == AF_INET || domain == AF_INET6 || domain == AF_UNIX) {
    shim::tellUse("socket() makes a connection: what comes over it comes when it comes",
                  MOVE_BASE_ABSTRACT_CALLER);
  }
  return function(domain, type, protocol);
}

// ---- memory of several processes -------------------------------------------------------------

int shm_open(const char* name, int flags, mode_t mode) {
  static auto* const function = shim::real<int(const char*, int, mode_t)>("shm_open");
  shim::tellShared("shm_open()", MOVE_BASE_ABSTRACT_CALLER);
  return function(name, flags, mode);
}

int shmget(key_t key, size_t size, int flags) {
  static auto* const function = shim::real<int(key_t, size_t, int)>("shmget");
  shim::tellShared("shmget()", MOVE_BASE_ABSTRACT_CALLER);
  return function(key, size, flags);
}

void* mmap(void* address, size_t length, int protection, int flags, int file, off_t offset) {
  static auto* const function = shim::real<void*(void*, size_t, int, int, int, off_t)>("mmap");
  shim::tellMapped(flags, file, MOVE_BASE_ABSTRACT_CALLER);
  return function(address, length, protection, flags, file, offset);
}

void* mmap64(void* address, size_t length, int protection, int flags, int file, off64_t offset) {
  static auto* const function = shim::real<void*(void*, size_t, int, int, int, off64_t)>("mmap64");
  shim::tellMapped(flags, file, MOVE_BASE_ABSTRACT_CALLER);
  return function(address, length, protection, flags, file, offset);
}

// ---- the machine -----------------------------------------------------------------------------

int getloadavg(double loads[], int count) {
  static auto* const function = shim::real<int(double[], int)>("getloadavg");
  shim::tellUse("getloadavg() says how busy the machine is", MOVE_BASE_ABSTRACT_CALLER);
  return function(loads, count);
}

int sysinfo(struct sysinfo* info) {
  static auto* const function = shim::real<int(struct sysinfo*)>("sysinfo");
  shim::tellUse("sysinfo() says how busy the machine is", MOVE_BASE_ABSTRACT_CALLER);
  return function(info);
}

}  // extern "C"
#pragma GCC visibility pop
