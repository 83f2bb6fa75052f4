// Random numbers, devices of random bytes, and files in which the system describes itself. No ROS.
#include <fcntl.h>
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

/** @return what the caller sees, who is about to draw: in a thread without an order that is noted.
 */
Sees drawing(const void* caller) {
  const Sees whose = sees(caller);
  if (whose == Sees::kStray) {
    notice(What::kStrayChance, caller);
  }
  return whose;
}

/** @brief Fill @p buffer with the run's bytes. @return false if the caller sees the machine's. */
bool fill(void* buffer, std::size_t size, const void* caller) {
  const Sees whose = drawing(caller);
  if (whose == Sees::kMachine) {
    return false;
  }
  (whose == Sees::kRun ? of_run : of_strays).fill(buffer, size);
  return true;
}

/** @brief Draw from a generator of libc, which all threads share. */
template <typename Result>
Result draw(Real<Result()>& function, const void* caller) {
  drawing(caller);
  return function();
}

/** @return a descriptor of a file with 1 MiB of the run's own random bytes; -1 if @p path is not a
 * device of random bytes, or the caller sees the machine's. */
int openEntropy(const char* path, int flags, const void* caller) {
  if (!shim::isEntropy(path) || drawing(caller) == Sees::kMachine) {
    return -1;
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

/** @brief The opening of a file by a library: a device of random bytes has the run's. */
class Opening {
 public:
  Opening(const char* path, int flags, const void* caller) {
    const bool is_seen =
        path != nullptr && shim::isOfSystem(path) && sees(caller) != Sees::kMachine;
    file_ = is_seen ? openEntropy(path, flags, caller) : -1;
    if (is_seen && file_ < 0) {
      notice(What::kDevice, caller);
    }
  }
  Opening(const char* path, const char* /*how*/, const void* caller)
      : Opening(path, O_CLOEXEC, caller) {}

  bool isDone() const { return file_ >= 0; }
  int file() const { return file_; }
  template <typename Result>
  Result noted(Result opened) const {
    return opened;
  }

 private:
  int file_ = -1;
};

}  // namespace

void seedGenerators() {
  const char* const text = seedText();
  new (&of_run) ByteStream(numberFor(text, "libraries"));
  new (&of_strays) ByteStream(numberFor(text, "strays of libraries"));
  srandom(static_cast<unsigned>(numberFor(text, "random")));
  srand48(static_cast<long>(numberFor(text, "drand48")));
}

}  // namespace move_base_abstract::native

#include "libc/chance.h"
#include "libc/files.h"
