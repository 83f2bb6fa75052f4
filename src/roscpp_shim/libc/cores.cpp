#include "cores.h"

#include <pthread.h>

#include <atomic>
#include <cstddef>

#include "libc/affinity.h"
#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"

namespace move_base_abstract::shim {
namespace {

cpu_set_t own;
std::atomic<bool> is_known{false};  // also false after the program has chosen cores itself

int kernelGet(pid_t thread, std::size_t size, cpu_set_t* cores) {
  static auto* const function = real(&::sched_getaffinity, "sched_getaffinity");
  return function(thread, size, cores);
}

int kernelSet(pid_t thread, std::size_t size, const cpu_set_t* cores) {
  static auto* const function = real(&::sched_setaffinity, "sched_setaffinity");
  return function(thread, size, cores);
}

/** The library is loaded before the program takes part, so these are its own cores. */
__attribute__((constructor)) void remember() {
  is_known = kernelGet(0, sizeof own, &own) == 0 && CPU_COUNT(&own) > 1;
}

/** @return whether @p cores is the one core on which the run is kept, not the own cores. */
bool isBound(const cpu_set_t& cores) {
  cpu_set_t both;
  CPU_AND(&both, &cores, &own);
  return is_known && CPU_COUNT(&cores) == 1 && CPU_COUNT(&both) == 1;
}

/** @brief Show the process's own cores instead of the one core of the run; TBB sees one of them. */
void show(std::size_t size, cpu_set_t* cores, const void* caller) {
  if (size >= sizeof own && isBound(*cores)) {
    *cores = own;
  }
  if (isTbb(caller) && sees() != Sees::kMachine) {
    keepFirst(size, cores);
  }
}

}  // namespace

OwnCores::OwnCores() {
  is_lifted_ = is_known && kernelGet(0, sizeof bound_, &bound_) == 0 && isBound(bound_) &&
               kernelSet(0, sizeof own, &own) == 0;
}

OwnCores::~OwnCores() {
  if (is_lifted_) {
    kernelSet(0, sizeof bound_, &bound_);
  }
}

}  // namespace move_base_abstract::shim

#pragma GCC visibility push(default)
extern "C" {

int sched_getaffinity(pid_t thread, size_t size, cpu_set_t* cores) {
  const int result = shim::kernelGet(thread, size, cores);
  if (result == 0) {
    shim::show(size, cores, MOVE_BASE_ABSTRACT_CALLER);
  }
  return result;
}

int pthread_getaffinity_np(pthread_t thread, size_t size, cpu_set_t* cores) {
  static auto* const function = shim::real(&::pthread_getaffinity_np, "pthread_getaffinity_np");
  const int result = function(thread, size, cores);
  if (result == 0) {
    shim::show(size, cores, MOVE_BASE_ABSTRACT_CALLER);
  }
  return result;
}

/** The program's own choice is respected, and never changed. */
int sched_setaffinity(pid_t thread, size_t size, const cpu_set_t* cores) {
  shim::is_known = false;
  return shim::kernelSet(thread, size, cores);
}

int pthread_setaffinity_np(pthread_t thread, size_t size, const cpu_set_t* cores) {
  static auto* const function = shim::real(&::pthread_setaffinity_np, "pthread_setaffinity_np");
  shim::is_known = false;
  return function(thread, size, cores);
}

}  // extern "C"
#pragma GCC visibility pop
