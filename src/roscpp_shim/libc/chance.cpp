// The program's random numbers: they follow from the seed, the node's name and the number of draws.
#include "chance.h"

#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <string>
#include <type_traits>

#include "libc/byte_stream.h"
#include "libc/devices.h"
#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/node.h"
#include "roscpp_shim/turn.h"

namespace move_base_abstract::shim {
namespace {

/** @return a number for the run's seed, the node's name and @p purpose. */
std::uint64_t numberFor(const std::string& purpose) {
  return shim::numberFor(seedText().c_str(), purpose.c_str());
}

/** @return what the calling thread sees, which is about to draw. */
Sees drawing(const void* caller) {
  const Sees whose = sees();
  if (whose == Sees::kStray) {
    tell("a random number is drawn in a thread that lockstep does not order", caller);
  }
  return whose;
}

/** @brief Fill a buffer with the run's random bytes. @return false if the machine's are to be used.
 */
bool fill(void* buffer, std::size_t size, const void* caller) {
  const Sees whose = drawing(caller);
  if (whose == Sees::kMachine) {
    return false;
  }
  static ByteStream* const of_run = new ByteStream(numberFor("entropy"));
  static ByteStream* const of_strays = new ByteStream(numberFor("strays"));
  (whose == Sees::kRun ? of_run : of_strays)->fill(buffer, size);
  return true;
}

/** @brief Make a UUID (RFC 4122) of 16 such bytes. @return false if the machine is to make it. */
bool name(unsigned char* out, int version, const void* caller) {
  if (!fill(out, 16, caller)) {
    return false;
  }
  out[6] = static_cast<unsigned char>((out[6] & 0x0F) | version << 4);
  out[8] = static_cast<unsigned char>((out[8] & 0x3F) | 0x80);
  return true;
}

using Generate = void(unsigned char*);

/** @brief Make such a UUID, or one by libuuid's own @p function. */
void nameOr(Generate* function, unsigned char* out, int version, const void* caller) {
  if (!name(out, version, caller)) {
    function(out);
  }
}

/** Draw from a generator of libc, which all threads share. roscpp's own threads get numbers of
 * their own, so that they do not change those of the program. */
template <typename Result>
Result draw(Real<Result()>& function, const void* caller) {
  if constexpr (std::is_integral_v<Result>) {
    if (Turn::isInternal() && takesPart()) {
      thread_local unsigned own = 1;
      return static_cast<Result>(::rand_r(&own));
    }
  }
  drawing(caller);
  return function();
}

/** Start libc's generators from the seed; the program may still seed them itself. */
__attribute__((constructor)) void seedGenerators() {
  if (sees() != Sees::kMachine) {
    ::srandom(static_cast<unsigned>(numberFor("random")));
    ::srand48(static_cast<long>(numberFor("drand48")));
  }
}

}  // namespace

int openEntropy(const char* path, int flags, const void* caller) {
  if (!isEntropy(path) || drawing(caller) == Sees::kMachine) {
    return -1;
  }
  const Inside inside;
  static std::atomic<int> opened{0};
  const int file = fileOf(ByteStream(numberFor("file " + std::to_string(++opened))), flags);
  if (file < 0) {
    tell(std::string(path) + " cannot be stood in for, and is the machine's", caller);
  }
  return file;
}

namespace {

/** @brief Label the run if the program's own code asks for a number of the kernel's. */
void tellNumber(const char* name, const void* caller) {
  if (sees() != Sees::kMachine && isProgramsOwn(caller)) {
    tell(std::string(name) + " is another number in another run", caller);
  }
}

}  // namespace
}  // namespace move_base_abstract::shim

#include "libc/chance.h"

#pragma GCC visibility push(default)
extern "C" {

// ---- unique names ----------------------------------------------------------------------------

// libuuid mixes the numbers of process and thread into its random bytes. For UUIDs by time it also
// uses the computer's address and the UUIDs that were made before.

void uuid_generate(unsigned char* out) {
  static auto* const function = shim::real(&::uuid_generate, "uuid_generate");
  shim::nameOr(function, out, 4, MOVE_BASE_ABSTRACT_CALLER);
}

void uuid_generate_random(unsigned char* out) {
  static auto* const function = shim::real(&::uuid_generate_random, "uuid_generate_random");
  shim::nameOr(function, out, 4, MOVE_BASE_ABSTRACT_CALLER);
}

void uuid_generate_time(unsigned char* out) {
  static auto* const function = shim::real(&::uuid_generate_time, "uuid_generate_time");
  shim::nameOr(function, out, 1, MOVE_BASE_ABSTRACT_CALLER);
}

int uuid_generate_time_safe(unsigned char* out) {
  static auto* const function = shim::real(&::uuid_generate_time_safe, "uuid_generate_time_safe");
  return shim::name(out, 1, MOVE_BASE_ABSTRACT_CALLER) ? 0 : function(out);
}

// ---- numbers of processes and threads --------------------------------------------------------

pid_t getpid() {
  static auto* const function = shim::real(&::getpid, "getpid");
  shim::tellNumber("getpid()", MOVE_BASE_ABSTRACT_CALLER);
  return function();
}

pid_t getppid() {
  static auto* const function = shim::real(&::getppid, "getppid");
  shim::tellNumber("getppid()", MOVE_BASE_ABSTRACT_CALLER);
  return function();
}

pid_t gettid() {
  static auto* const function = shim::real(&::gettid, "gettid");
  shim::tellNumber("gettid()", MOVE_BASE_ABSTRACT_CALLER);
  return function();
}

}  // extern "C"
#pragma GCC visibility pop
