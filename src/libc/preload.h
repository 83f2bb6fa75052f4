// The environment variable by which a library is preloaded. Both preloaded libraries use it. No
// ROS.
#pragma once

#include <stdlib.h>
#include <string.h>

namespace move_base_abstract::shim {

/**
 * @brief Take a library out of LD_PRELOAD, so that programs which this one starts do not load it.
 * @param own a part of its name. @return whether it was there.
 */
inline bool leavePreload(const char* own) {
  constexpr const char* kVariable = "LD_PRELOAD";
  const char* const preload = getenv(kVariable);
  char* const names = preload == nullptr ? nullptr : strdup(preload);
  char* const others = preload == nullptr ? nullptr : strdup(preload);
  if (names == nullptr || others == nullptr) {
    return false;
  }
  *others = '\0';
  bool is_found = false;
  char* rest = nullptr;
  for (char* name = strtok_r(names, " :", &rest); name != nullptr;
       name = strtok_r(nullptr, " :", &rest)) {
    if (strstr(name, own) != nullptr) {
      is_found = true;
    } else {
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
  return is_found;
}

}  // namespace move_base_abstract::shim
