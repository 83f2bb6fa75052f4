// Devices of random bytes, and files in which the system describes itself. No ROS.
#include <fcntl.h>

#include "chance.h"
#include "libc/devices.h"
#include "notices.h"
#include "real.h"
#include "run.h"

namespace move_base_abstract::native {
namespace {

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
}  // namespace move_base_abstract::native

namespace policy = move_base_abstract::native;
#include "libc/files.h"
