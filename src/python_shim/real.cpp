// No ROS.
#include "real.h"

#include <dlfcn.h>
#include <string.h>

namespace move_base_abstract::native {
namespace {

/**
 * Versions of glibc's symbols, newest first. If libc also has an old function of the same name,
 * dlsym() may find that one, so all versions are tried in this order.
 */
constexpr const char* kVersions[] = {"GLIBC_2.36", "GLIBC_2.34",  "GLIBC_2.30",
                                     "GLIBC_2.17", "GLIBC_2.3.2", "GLIBC_2.2.5"};

}  // namespace

void* findReal(const char* symbol) {
  if (strncmp(symbol, "_Z", 2) == 0) {  // in the C++ library, which extension modules load
    void* const library = dlopen("libstdc++.so.6", RTLD_LAZY | RTLD_NOLOAD);
    return library == nullptr ? nullptr : dlsym(library, symbol);
  }
  for (const char* version : kVersions) {
    void* const found = dlvsym(RTLD_NEXT, symbol, version);
    if (found != nullptr) {
      return found;
    }
  }
  return dlsym(RTLD_NEXT, symbol);
}

}  // namespace move_base_abstract::native
