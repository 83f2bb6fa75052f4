// No ROS.
#include "run.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "callers.h"
#include "chance.h"

namespace move_base_abstract::native {
namespace {

using Sleep = int(Nanoseconds);

std::atomic<Sleep*> sleep_in_python{nullptr};
char* seed_text = nullptr;
thread_local Nanoseconds t_epoch __attribute__((tls_model("initial-exec"))) = 0;

/** Take this library out of LD_PRELOAD, so that programs that this one starts do not load it. */
__attribute__((constructor)) void leaveEnvironment() {
  constexpr const char* kVariable = "LD_PRELOAD";
  const char* const preload = getenv(kVariable);
  char* const names = preload == nullptr ? nullptr : strdup(preload);
  char* const others = preload == nullptr ? nullptr : strdup(preload);
  if (names == nullptr || others == nullptr) {
    return;
  }
  *others = '\0';
  char* rest = nullptr;
  for (char* name = strtok_r(names, " :", &rest); name != nullptr;
       name = strtok_r(nullptr, " :", &rest)) {
    if (strstr(name, "python_shim") == nullptr) {
      strcat(strcat(others, *others == '\0' ? "" : " "), name);
    }
  }
  if (*others == '\0') {
    unsetenv(kVariable);
  } else {
    setenv(kVariable, others, 1);
  }
  free(names);
  free(others);
}

}  // namespace

std::atomic<Nanoseconds> cells[kCells];

Sees sees(const void* caller) {
  if (cell(kIsFollowed) == 0 || !isFollowed(caller)) {
    return Sees::kMachine;
  }
  return t_epoch == cell(kEpoch) ? Sees::kRun : Sees::kStray;
}

bool sleepInPython(Nanoseconds duration) {
  Sleep* const function = sleep_in_python.load();
  return function == nullptr || function(duration) == 0;
}

const char* seedText() { return seed_text == nullptr ? "" : seed_text; }

}  // namespace move_base_abstract::native

namespace native = move_base_abstract::native;

#pragma GCC visibility push(default)
extern "C" {

// The functions that Python calls, by ctypes.

std::atomic<std::int64_t>* move_base_abstract_native_cells() { return native::cells; }

/** @brief Make libraries see the run's chance from now on. @p text is the seed and the node's name;
 * @p sleep is Python's function for sleepInPython(). */
void move_base_abstract_native_begin(const char* text, int (*sleep)(std::int64_t)) {
  native::seed_text = strdup(text);
  native::sleep_in_python = sleep;
  native::seedGenerators();
}

/** @brief Note that the calling thread takes turns from now on, or stops taking turns. */
void move_base_abstract_native_enter(int is_entering) {
  native::t_epoch = is_entering != 0 ? native::cell(native::kEpoch) : -1;
}

}  // extern "C"
#pragma GCC visibility pop
