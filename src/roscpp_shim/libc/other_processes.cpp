// Calls that start processes which take no part, or share something with them. They label the run.
#include <fcntl.h>
#include <mqueue.h>
#include <netinet/in.h>
#include <sys/mman.h>
#include <sys/msg.h>
#include <sys/sem.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <threads.h>
#include <unistd.h>

#include <cstdarg>
#include <optional>
#include <string>

#include "cores.h"
#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/parameters.h"
#include "roscpp_shim/turn.h"

namespace move_base_abstract::shim {
namespace {

/** @brief Label the run: the program, or a library that works for it, does @p what. Calls by roscpp
 * itself are left out. */
void tellUse(const char* what, const void* caller) {
  if (!Turn::isInside() && !Turn::isInternal() && sees() != Sees::kMachine && !isRoscpps(caller)) {
    tell(what, caller);
  }
}

constexpr const char* kTimes = "times() says how long the processor has worked";
constexpr const char* kUsage = "getrusage() says how long the processor has worked";
constexpr const char* kLoad = "getloadavg() says how busy the machine is";
constexpr const char* kSystem = "sysinfo() says how busy the machine is";

/** @brief Label the run, because the kernel wakes the program by the wall clock. */
void tellTimer(const std::string& name, const void* caller) {
  if (!isRoscpps(caller) && sees() != Sees::kMachine) {
    tell(name + " has the kernel wake the program by the wall clock", caller);
  }
}

/** @brief The start of a process that takes no part, by the function @p name: it labels the run. */
class Start {
 public:
  Start(const std::string& name, const void* caller) {
    tellUse(
        (name + " starts a process that is not a participant: its answers depend on the machine")
            .c_str(),
        caller);
    parameters().settle();
    cores_.emplace();
  }
  void goOnIn(pid_t process) {
    if (process == 0) {
      cores_->keep();
    }
  }

 private:
  std::optional<OwnCores> cores_;
};

/** @brief Label the run, because the program shares memory with other processes. Memory that
 * libraries of the system share does not matter. */
void tellShared(const std::string& name, const void* caller) {
  if (!Turn::isInside() && !Turn::isInternal() && sees() != Sees::kMachine &&
      isProgramsOwn(caller)) {
    tell(name + " shares memory with other processes: they write to it by the wall clock", caller);
  }
}

/** @brief Label the run, because queues and semaphores with a name in the system are shared. */
void tellQueue(const std::string& name, const void* caller) {
  tellUse((name + " opens a queue or semaphore of several processes: they use it by the wall clock")
              .c_str(),
          caller);
}

/** @brief Label the run: libc makes C11's threads itself, and calls no function that this library
 * could replace. */
void tellC11(const std::string& name, const void* caller) {
  tellUse(
      (name + " is not followed: C11's threads take no turns, and wait by the wall clock").c_str(),
      caller);
}

void tellMapped(int flags, int file, const void* caller) {
  if ((flags & MAP_SHARED) != 0 && file >= 0) {
    tellShared("mmap()", caller);
  }
}

}  // namespace
}  // namespace move_base_abstract::shim

#include "libc/unfollowed_calls.h"

#pragma GCC visibility push(default)
extern "C" {

// ---- connections -----------------------------------------------------------------------------

int socket(int domain, int type, int protocol) {
  static auto* const function = shim::real(&::socket, "socket");
  if (domain == AF_INET || domain == AF_INET6 || domain == AF_UNIX) {
    shim::tellUse("socket() makes a connection: data arrives over it by the wall clock",
                  MOVE_BASE_ABSTRACT_CALLER);
  }
  return function(domain, type, protocol);
}

// ---- memory of several processes -------------------------------------------------------------

int shm_open(const char* name, int flags, mode_t mode) {
  static auto* const function = shim::real(&::shm_open, "shm_open");
  shim::tellShared("shm_open()", MOVE_BASE_ABSTRACT_CALLER);
  return function(name, flags, mode);
}

int shmget(key_t key, size_t size, int flags) {
  static auto* const function = shim::real(&::shmget, "shmget");
  shim::tellShared("shmget()", MOVE_BASE_ABSTRACT_CALLER);
  return function(key, size, flags);
}

void* mmap(void* address, size_t length, int protection, int flags, int file, off_t offset) {
  static auto* const function = shim::real(&::mmap, "mmap");
  shim::tellMapped(flags, file, MOVE_BASE_ABSTRACT_CALLER);
  return function(address, length, protection, flags, file, offset);
}
asm(".globl mmap64\n.set mmap64, mmap");  // an offset is the same here

// ---- queues of several processes -------------------------------------------------------------

mqd_t mq_open(const char* name, int flags, ...) {
  static auto* const function = shim::real(&::mq_open, "mq_open");
  shim::tellQueue("mq_open()", MOVE_BASE_ABSTRACT_CALLER);
  if ((flags & O_CREAT) == 0) {
    return function(name, flags);
  }
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = va_arg(rest, mode_t);
  mq_attr* const attributes = va_arg(rest, mq_attr*);
  va_end(rest);
  return function(name, flags, mode, attributes);
}

int msgget(key_t key, int flags) {
  static auto* const function = shim::real(&::msgget, "msgget");
  shim::tellQueue("msgget()", MOVE_BASE_ABSTRACT_CALLER);
  return function(key, flags);
}

int semget(key_t key, int count, int flags) {
  static auto* const function = shim::real(&::semget, "semget");
  shim::tellQueue("semget()", MOVE_BASE_ABSTRACT_CALLER);
  return function(key, count, flags);
}

// ---- C11's threads ---------------------------------------------------------------------------

int thrd_create(thrd_t* thread, thrd_start_t start, void* argument) {
  static auto* const function = shim::real(&::thrd_create, "thrd_create");
  shim::tellC11("thrd_create()", MOVE_BASE_ABSTRACT_CALLER);
  return function(thread, start, argument);
}

int thrd_sleep(const timespec* duration, timespec* rest) {
  static auto* const function = shim::real(&::thrd_sleep, "thrd_sleep");
  shim::tellC11("thrd_sleep()", MOVE_BASE_ABSTRACT_CALLER);
  return function(duration, rest);
}

int cnd_timedwait(cnd_t* condition, mtx_t* mutex, const timespec* until) {
  static auto* const function = shim::real(&::cnd_timedwait, "cnd_timedwait");
  shim::tellC11("cnd_timedwait()", MOVE_BASE_ABSTRACT_CALLER);
  return function(condition, mutex, until);
}

int mtx_timedlock(mtx_t* mutex, const timespec* until) {
  static auto* const function = shim::real(&::mtx_timedlock, "mtx_timedlock");
  shim::tellC11("mtx_timedlock()", MOVE_BASE_ABSTRACT_CALLER);
  return function(mutex, until);
}

}  // extern "C"
#pragma GCC visibility pop
