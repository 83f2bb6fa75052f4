// The random numbers of libc and of the C++ library, for a preloaded library. Its one source that
// includes this has `policy`, a namespace with Real<Function> and
//   bool fill(void*, std::size_t, const void* caller);  // false: the caller sees the machine's
//   Result draw(Real<Result()>&, const void* caller);   // from a generator of libc
// No ROS.
#include <stdlib.h>
#include <sys/random.h>

#include <cstdint>

#include "looked_up.h"

#pragma GCC visibility push(default)
extern "C" {

// ---- generators of libc ----------------------------------------------------------------------

int rand() {
  static policy::Real<int()> function("rand");
  return policy::draw(function, MOVE_BASE_ABSTRACT_CALLER);
}

long random() {
  static policy::Real<long()> function("random");
  return policy::draw(function, MOVE_BASE_ABSTRACT_CALLER);
}

double drand48() {
  static policy::Real<double()> function("drand48");
  return policy::draw(function, MOVE_BASE_ABSTRACT_CALLER);
}

long lrand48() {
  static policy::Real<long()> function("lrand48");
  return policy::draw(function, MOVE_BASE_ABSTRACT_CALLER);
}

long mrand48() {
  static policy::Real<long()> function("mrand48");
  return policy::draw(function, MOVE_BASE_ABSTRACT_CALLER);
}

// ---- chance of the machine -------------------------------------------------------------------

ssize_t getrandom(void* buffer, size_t size, unsigned flags) {
  static policy::Real<ssize_t(void*, size_t, unsigned)> function("getrandom");
  return policy::fill(buffer, size, MOVE_BASE_ABSTRACT_CALLER) ? static_cast<ssize_t>(size)
                                                               : function(buffer, size, flags);
}

int getentropy(void* buffer, size_t size) {
  static policy::Real<int(void*, size_t)> function("getentropy");
  return policy::fill(buffer, size, MOVE_BASE_ABSTRACT_CALLER) ? 0 : function(buffer, size);
}

std::uint32_t arc4random() {
  static policy::Real<std::uint32_t()> function("arc4random");
  std::uint32_t number = 0;
  return policy::fill(&number, sizeof number, MOVE_BASE_ABSTRACT_CALLER) ? number : function();
}

void arc4random_buf(void* buffer, size_t size) {
  static policy::Real<void(void*, size_t)> function("arc4random_buf");
  if (!policy::fill(buffer, size, MOVE_BASE_ABSTRACT_CALLER)) {
    function(buffer, size);
  }
}

std::uint32_t arc4random_uniform(std::uint32_t bound) {
  static policy::Real<std::uint32_t(std::uint32_t)> function("arc4random_uniform");
  std::uint64_t number = 0;
  if (!policy::fill(&number, sizeof number, MOVE_BASE_ABSTRACT_CALLER)) {
    return function(bound);
  }
  return bound < 2 ? 0 : static_cast<std::uint32_t>(number % bound);  // off by less than 2^-32
}

/** std::random_device::_M_getval(), for every kind of device: the processor's instructions, the
 * kernel, a file. */
unsigned _ZNSt13random_device9_M_getvalEv(void* device) {
  static policy::Real<unsigned(void*)> function("_ZNSt13random_device9_M_getvalEv");
  unsigned number = 0;
  return policy::fill(&number, sizeof number, MOVE_BASE_ABSTRACT_CALLER) ? number
                                                                         : function(device);
}

}  // extern "C"
#pragma GCC visibility pop
