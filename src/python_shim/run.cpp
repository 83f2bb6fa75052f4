// No ROS.
#include "run.h"

#include <stdlib.h>
#include <string.h>

#include "callers.h"
#include "libc/crashes.h"
#include "libc/preload.h"

namespace move_base_abstract::native {
namespace {

using Sleep = int(Nanoseconds);

std::atomic<Sleep*> sleep_in_python{nullptr};
char* seed_text = nullptr;
shim::CrashWord crash_word;
thread_local Nanoseconds t_epoch __attribute__((tls_model("initial-exec"))) = 0;

__attribute__((constructor)) void leaveEnvironment() { shim::leavePreload("python_shim"); }

}  // namespace

std::atomic<Nanoseconds> cells[kCells];

Sees sees(const void* caller) {
  if (cell(kIsFollowed) == 0 || !isFollowed(caller)) {
    return Sees::kMachine;
  }
  return hasTurns() ? Sees::kRun : Sees::kStray;
}

bool hasTurns() { return t_epoch == cell(kEpoch); }

bool sleepInPython(Nanoseconds duration) {
  Sleep* const function = sleep_in_python.load();
  return function == nullptr || function(duration) == 0;
}

void tellOfCrashes(int socket, pid_t process, const char* bytes, size_t size) {
  crash_word.bytes = bytes;
  crash_word.size = size;
  crash_word.process = process;
  crash_word.socket = socket;
  shim::tellOfCrashes<crash_word>();
}

const char* seedText() { return seed_text == nullptr ? "" : seed_text; }

}  // namespace move_base_abstract::native

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

/** @brief Send @p bytes, which stay where they are, to @p socket if the process, whose number is
 * @p process, crashes. */
void move_base_abstract_native_crashes(int socket, int process, const char* bytes,
                                       std::size_t size) {
  native::tellOfCrashes(socket, process, bytes, size);
}

/** @brief Note that the calling thread takes turns from now on, or stops taking turns. */
void move_base_abstract_native_enter(int is_entering) {
  native::t_epoch = is_entering != 0 ? native::cell(native::kEpoch) : -1;
}

}  // extern "C"
#pragma GCC visibility pop
