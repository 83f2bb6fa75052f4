// No ROS.
#include "chance.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <unistd.h>

#include <new>

#include "notices.h"
#include "real.h"
#include "roscpp_shim/machine/byte_stream.h"
#include "roscpp_shim/machine/devices.h"
#include "run.h"

namespace move_base_abstract::native {
namespace {

using shim::ByteStream;
using shim::numberFor;

ByteStream of_run(0);
ByteStream of_strays(0);

/** @brief Fill @p buffer with the run's bytes. @return false if the caller sees the machine's. */
bool fill(void* buffer, std::size_t size, const void* caller) {
  const Sees whose = sees(caller);
  if (whose == Sees::kMachine) {
    return false;
  }
  if (whose == Sees::kStray) {
    notice(What::kStrayChance, caller);
  }
  (whose == Sees::kRun ? of_run : of_strays).fill(buffer, size);
  return true;
}

/** @brief Note a draw from libc's generators in a thread without an order: all threads share them.
 */
void checkOrder(const void* caller) {
  if (sees(caller) == Sees::kStray) {
    notice(What::kStrayChance, caller);
  }
}

bool writeBytes(int file, ByteStream* bytes) {
  constexpr int kParts = 256;
  char part[4096];
  for (int k = 0; k < kParts; ++k) {
    bytes->fill(part, sizeof part);
    if (write(file, part, sizeof part) != static_cast<ssize_t>(sizeof part)) {
      return false;
    }
  }
  return lseek(file, 0, SEEK_SET) == 0;
}

}  // namespace

void seedGenerators() {
  const char* const text = seedText();
  new (&of_run) ByteStream(numberFor(text, "libraries"));
  new (&of_strays) ByteStream(numberFor(text, "strays of libraries"));
  srandom(static_cast<unsigned>(numberFor(text, "random")));
  srand48(static_cast<long>(numberFor(text, "drand48")));
}

int openEntropy(const char* path, int flags, const void* caller) {
  const Sees whose = shim::isEntropy(path) ? sees(caller) : Sees::kMachine;
  if (whose == Sees::kMachine) {
    return -1;
  }
  if (whose == Sees::kStray) {
    notice(What::kStrayChance, caller);
  }
  static std::atomic<int> opened{0};
  char purpose[32];
  snprintf(purpose, sizeof purpose, "file %d", ++opened);
  ByteStream bytes(numberFor(seedText(), purpose));
  const int file = memfd_create("entropy", (flags & O_CLOEXEC) != 0 ? MFD_CLOEXEC : 0);
  if (file < 0 || !writeBytes(file, &bytes)) {
    notice(What::kEntropy, caller);
    if (file >= 0) {
      close(file);
    }
    return -1;
  }
  return file;
}

}  // namespace move_base_abstract::native

namespace native = move_base_abstract::native;

#pragma GCC visibility push(default)
extern "C" {

// ---- generators of libc ----------------------------------------------------------------------

int rand() {
  static native::Real<int()> function("rand");
  native::checkOrder(MOVE_BASE_ABSTRACT_CALLER);
  return function();
}

long random() {
  static native::Real<long()> function("random");
  native::checkOrder(MOVE_BASE_ABSTRACT_CALLER);
  return function();
}

double drand48() {
  static native::Real<double()> function("drand48");
  native::checkOrder(MOVE_BASE_ABSTRACT_CALLER);
  return function();
}

long lrand48() {
  static native::Real<long()> function("lrand48");
  native::checkOrder(MOVE_BASE_ABSTRACT_CALLER);
  return function();
}

long mrand48() {
  static native::Real<long()> function("mrand48");
  native::checkOrder(MOVE_BASE_ABSTRACT_CALLER);
  return function();
}

// ---- chance of the machine -------------------------------------------------------------------

ssize_t getrandom(void* buffer, size_t size, unsigned flags) {
  static native::Real<ssize_t(void*, size_t, unsigned)> function("getrandom");
  return native::fill(buffer, size, MOVE_BASE_ABSTRACT_CALLER) ? static_cast<ssize_t>(size)
                                                               : function(buffer, size, flags);
}

int getentropy(void* buffer, size_t size) {
  static native::Real<int(void*, size_t)> function("getentropy");
  return native::fill(buffer, size, MOVE_BASE_ABSTRACT_CALLER) ? 0 : function(buffer, size);
}

std::uint32_t arc4random() {
  static native::Real<std::uint32_t()> function("arc4random");
  std::uint32_t number = 0;
  return native::fill(&number, sizeof number, MOVE_BASE_ABSTRACT_CALLER) ? number : function();
}

void arc4random_buf(void* buffer, size_t size) {
  static native::Real<void(void*, size_t)> function("arc4random_buf");
  if (!native::fill(buffer, size, MOVE_BASE_ABSTRACT_CALLER)) {
    function(buffer, size);
  }
}

std::uint32_t arc4random_uniform(std::uint32_t bound) {
  static native::Real<std::uint32_t(std::uint32_t)> function("arc4random_uniform");
  std::uint64_t number = 0;
  if (!native::fill(&number, sizeof number, MOVE_BASE_ABSTRACT_CALLER)) {
    return function(bound);
  }
  return bound < 2 ? 0 : static_cast<std::uint32_t>(number % bound);  // off by less than 2^-32
}

/** std::random_device::_M_getval(), for a device of any name. */
unsigned _ZNSt13random_device9_M_getvalEv(void* device) {
  static native::Real<unsigned(void*)> function("_ZNSt13random_device9_M_getvalEv");
  unsigned number = 0;
  return native::fill(&number, sizeof number, MOVE_BASE_ABSTRACT_CALLER) ? number
                                                                         : function(device);
}

}  // extern "C"
#pragma GCC visibility pop
