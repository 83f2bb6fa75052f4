// The functions of libc that open files, for a preloaded library. Its one source that includes this
// has `policy`, a namespace with Real<Function> and
//   Opening(const char* path, int flags, const void* caller);        // by open()
//   Opening(const char* path, const char* how, const void* caller);  // by fopen()
//   bool isDone() const;            // whether the file is open already, as file()
//   int file() const;
//   Result noted(Result opened) const;  // called with what the real function has returned
// No ROS.
#include <fcntl.h>
#include <stdio.h>

#include <cstdarg>

#include "devices.h"
#include "looked_up.h"

#define MOVE_BASE_ABSTRACT_MODE(last)                             \
  va_list rest;                                                   \
  va_start(rest, last);                                           \
  const auto mode = va_arg(rest, unsigned); /* if flags say so */ \
  va_end(rest)

#pragma GCC visibility push(default)
extern "C" {

int open(const char* path, int flags, ...) {
  static policy::Real<int(const char*, int, ...)> function("open");
  MOVE_BASE_ABSTRACT_MODE(flags);
  const policy::Opening opening(path, flags, MOVE_BASE_ABSTRACT_CALLER);
  return opening.isDone() ? opening.file() : opening.noted(function(path, flags, mode));
}

int openat(int folder, const char* path, int flags, ...) {
  static policy::Real<int(int, const char*, int, ...)> function("openat");
  MOVE_BASE_ABSTRACT_MODE(flags);
  const char* const whole = move_base_abstract::shim::ofNoFolder(folder, path);
  const policy::Opening opening(whole, flags, MOVE_BASE_ABSTRACT_CALLER);
  return opening.isDone() ? opening.file() : opening.noted(function(folder, path, flags, mode));
}

int __open_2(const char* path, int flags) {
  static policy::Real<int(const char*, int)> function("__open_2");
  const policy::Opening opening(path, flags, MOVE_BASE_ABSTRACT_CALLER);
  return opening.isDone() ? opening.file() : opening.noted(function(path, flags));
}

FILE* fopen(const char* path, const char* how) {
  static policy::Real<FILE*(const char*, const char*)> function("fopen");
  const policy::Opening opening(path, how, MOVE_BASE_ABSTRACT_CALLER);
  return opening.isDone() ? ::fdopen(opening.file(), "r") : opening.noted(function(path, how));
}

// Files of more than 32 bits are the usual ones here.
asm(".globl open64, openat64, __open64_2, fopen64\n"
    ".set open64, open\n.set openat64, openat\n.set __open64_2, __open_2\n.set fopen64, fopen");

}  // extern "C"
#pragma GCC visibility pop
