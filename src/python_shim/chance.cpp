// No ROS.
#include "chance.h"

#include <stdio.h>
#include <stdlib.h>

#include <new>

#include "libc/byte_stream.h"
#include "libc/devices.h"
#include "notices.h"
#include "real.h"
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

/** @brief Draw from a generator of libc. A draw in a thread without an order is noted, as all
 * threads share them. */
template <typename Result>
Result draw(Real<Result()>& function, const void* caller) {
  if (sees(caller) == Sees::kStray) {
    notice(What::kStrayChance, caller);
  }
  return function();
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
  const int file = shim::fileOf(ByteStream(numberFor(seedText(), purpose)), flags);
  if (file < 0) {
    notice(What::kEntropy, caller);
  }
  return file;
}

}  // namespace move_base_abstract::native

namespace policy = move_base_abstract::native;
#include "libc/chance.h"
