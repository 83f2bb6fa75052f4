// No ROS.
#include "real.h"

#include <dlfcn.h>
#include <string.h>

namespace move_base_abstract::native {

void* findReal(const char* symbol) {
  if (strncmp(symbol, "_Z", 2) == 0) {  // in the C++ library, which extension modules load
    void* const library = dlopen("libstdc++.so.6", RTLD_LAZY | RTLD_NOLOAD);
    return library == nullptr ? nullptr : dlsym(library, symbol);
  }
  return shim::findNext(symbol);
}

}  // namespace move_base_abstract::native
