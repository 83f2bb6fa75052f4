// Files of the system and devices, whose content differs from run to run. Both preloaded libraries
// use this.
#pragma once

#include <fcntl.h>
#include <string.h>

#include <initializer_list>

namespace move_base_abstract::shim {

inline bool beginsWith(const char* path, std::initializer_list<const char*> beginnings) {
  for (const char* beginning : beginnings) {
    if (strncmp(path, beginning, strlen(beginning)) == 0) {
      return true;
    }
  }
  return false;
}

/** @return whether a file describes the system (/proc, /sys), or is a device. */
inline bool isOfSystem(const char* path) {
  const bool is_harmless = beginsWith(path, {"/dev/null", "/dev/zero", "/dev/full", "/dev/std",
                                             "/dev/tty", "/dev/pts/", "/dev/fd/", "/dev/shm/"});
  return beginsWith(path, {"/proc/", "/sys/", "/dev/"}) && !is_harmless;
}

/** @return whether a file is a device of random bytes. */
inline bool isEntropy(const char* path) {
  return path != nullptr && (strcmp(path, "/dev/urandom") == 0 || strcmp(path, "/dev/random") == 0);
}

/** @return the path of an openat() that does not need its folder; null: it needs it. */
inline const char* ofNoFolder(int folder, const char* path) {
  return folder == AT_FDCWD || path == nullptr || *path == '/' ? path : nullptr;
}

}  // namespace move_base_abstract::shim
