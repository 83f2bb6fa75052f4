// No ROS.
#include "notices.h"

#include <cerrno>

#include "callers.h"
#include "run.h"

namespace move_base_abstract::native {
namespace {

struct Notice {
  std::atomic<const void*> caller;  // null until the notice is written
  What what;
  const void* place;  // the code for which the caller works, beyond the C++ library
};

constexpr int kMost = 256;
Notice notices[kMost];
std::atomic<int> taken{0};

}  // namespace

void notice(What what, const void* caller) {
  int known = taken.load();
  for (int k = 0; k < known && k < kMost; ++k) {
    if (notices[k].caller.load(std::memory_order_acquire) == caller && notices[k].what == what) {
      return;
    }
  }
  const int place = taken.load() < kMost ? taken.fetch_add(1) : kMost;
  if (place >= kMost) {
    return;  // there are enough labels
  }
  const int error = errno;
  notices[place].what = what;
  notices[place].place = beyondWrappers(caller);
  notices[place].caller.store(caller, std::memory_order_release);
  cells[kNotices].fetch_add(1);
  errno = error;
}

}  // namespace move_base_abstract::native

#pragma GCC visibility push(default)
extern "C" {

/** @brief Read a notice: write the calling file's path, and the offset in it.
 * @return the kind of the notice (a What), or -1 if it is not written yet. */
int move_base_abstract_native_notice(int index, char* path, std::size_t size, std::size_t* offset) {
  if (index < 0 || index >= native::kMost || native::notices[index].caller.load() == nullptr) {
    return -1;
  }
  *offset = native::placeOf(native::notices[index].place, path, size);
  return static_cast<int>(native::notices[index].what);
}

}  // extern "C"
#pragma GCC visibility pop
