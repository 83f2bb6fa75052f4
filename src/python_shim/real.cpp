// No ROS.
#include "real.h"

#include <dlfcn.h>
#include <string.h>

namespace move_base_abstract::native {
namespace {

/**
 * Versions of glibc's symbols, newest first: where libc has an old function of the same name too,
 * dlsym() may find that one. Which of them a machine has is looked up.
 */
constexpr const char* kVersions[] = {"GLIBC_2.36", "GLIBC_2.34",  "GLIBC_2.30",
                                     "GLIBC_2.17", "GLIBC_2.3.2", "GLIBC_2.2.5"};

}  // namespace

void* findReal(const char* symbol) {
  if (strncmp(symbol, "_Z", 2) == 0) {  // of the C++ library, which plug-ins bring along
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
