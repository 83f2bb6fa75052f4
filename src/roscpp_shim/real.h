// The functions that this library stands in front of: roscpp's, librostime's and libc's own.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_REAL_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_REAL_H

#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>

namespace move_base_abstract::shim {

/**
 * @return the function that would have been called if this library were not here.
 * @param symbol as the linker knows it.
 * @param version of the symbol, for those of which libc has an old one too.
 */
template <typename Function>
Function* real(const char* symbol, const char* version = nullptr) {
  void* const found =
      version != nullptr ? dlvsym(RTLD_NEXT, symbol, version) : dlsym(RTLD_NEXT, symbol);
  if (found == nullptr) {
    std::fprintf(stderr,
                 "lockstep: this program's libraries have no %s: they must be those of roscpp "
                 "1.15 to 1.17 for which this package was built\n",
                 symbol);
    std::abort();
  }
  return reinterpret_cast<Function*>(found);
}

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_REAL_H
