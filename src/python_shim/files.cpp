// Devices of random bytes, and files in which the system describes itself. No ROS.
#include <fcntl.h>
#include <stdio.h>
#include <sys/types.h>

#include <cstdarg>

#include "chance.h"
#include "notices.h"
#include "real.h"
#include "roscpp_shim/machine/devices.h"
#include "run.h"

namespace move_base_abstract::native {
namespace {

/** @return a descriptor of the run's random bytes, if a library opens a device of them; -1 if not.
 */
int instead(const char* path, int flags, const void* caller) {
  const bool is_seen = path != nullptr && shim::isOfSystem(path) && sees(caller) != Sees::kMachine;
  const int file = is_seen ? openEntropy(path, flags, caller) : -1;
  if (is_seen && file < 0) {
    notice(What::kDevice, caller);
  }
  return file;
}

}  // namespace
}  // namespace move_base_abstract::native

namespace native = move_base_abstract::native;

#pragma GCC visibility push(default)
extern "C" {

#define MOVE_BASE_ABSTRACT_MODE(last)                                  \
  va_list rest;                                                        \
  va_start(rest, last);                                                \
  const auto mode = va_arg(rest, unsigned); /* used if flags say so */ \
  va_end(rest)

int open(const char* path, int flags, ...) {
  static native::Real<int(const char*, int, ...)> function("open");
  MOVE_BASE_ABSTRACT_MODE(flags);
  const int file = native::instead(path, flags, MOVE_BASE_ABSTRACT_CALLER);
  return file >= 0 ? file : function(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  static native::Real<int(const char*, int, ...)> function("open64");
  MOVE_BASE_ABSTRACT_MODE(flags);
  const int file = native::instead(path, flags, MOVE_BASE_ABSTRACT_CALLER);
  return file >= 0 ? file : function(path, flags, mode);
}

int openat(int folder, const char* path, int flags, ...) {
  static native::Real<int(int, const char*, int, ...)> function("openat");
  MOVE_BASE_ABSTRACT_MODE(flags);
  const int file = native::instead(path, flags, MOVE_BASE_ABSTRACT_CALLER);
  return file >= 0 ? file : function(folder, path, flags, mode);
}

int openat64(int folder, const char* path, int flags, ...) {
  static native::Real<int(int, const char*, int, ...)> function("openat64");
  MOVE_BASE_ABSTRACT_MODE(flags);
  const int file = native::instead(path, flags, MOVE_BASE_ABSTRACT_CALLER);
  return file >= 0 ? file : function(folder, path, flags, mode);
}

int __open_2(const char* path, int flags) {
  static native::Real<int(const char*, int)> function("__open_2");
  const int file = native::instead(path, flags, MOVE_BASE_ABSTRACT_CALLER);
  return file >= 0 ? file : function(path, flags);
}

int __open64_2(const char* path, int flags) {
  static native::Real<int(const char*, int)> function("__open64_2");
  const int file = native::instead(path, flags, MOVE_BASE_ABSTRACT_CALLER);
  return file >= 0 ? file : function(path, flags);
}

FILE* fopen(const char* path, const char* how) {
  static native::Real<FILE*(const char*, const char*)> function("fopen");
  const int file = native::instead(path, O_CLOEXEC, MOVE_BASE_ABSTRACT_CALLER);
  return file >= 0 ? fdopen(file, "r") : function(path, how);
}

FILE* fopen64(const char* path, const char* how) {
  static native::Real<FILE*(const char*, const char*)> function("fopen64");
  const int file = native::instead(path, O_CLOEXEC, MOVE_BASE_ABSTRACT_CALLER);
  return file >= 0 ? fdopen(file, "r") : function(path, how);
}

}  // extern "C"
#pragma GCC visibility pop
