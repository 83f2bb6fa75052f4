// The functions that this library stands in front of. No ROS.
#pragma once

#include <dlfcn.h>
#include <string.h>

#include "libc/looked_up.h"

namespace move_base_abstract::native {

/** @return the function that would be called without this library; null if there is none. */
inline void* findReal(const char* symbol) {
  if (strncmp(symbol, "_Z", 2) == 0) {  // in the C++ library, which extension modules load
    void* const library = dlopen("libstdc++.so.6", RTLD_LAZY | RTLD_NOLOAD);
    return library == nullptr ? nullptr : dlsym(library, symbol);
  }
  return shim::findNext(symbol);
}

/** @brief A function that is looked up when it is first called; null if this C library does not
 * have it. */
template <typename Function>
using Real = shim::LookedUp<Function, findReal>;

}  // namespace move_base_abstract::native

namespace shim = move_base_abstract::shim;
namespace policy = move_base_abstract::native;  // for the headers of libc/
