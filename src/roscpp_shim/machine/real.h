// The real functions that this library replaces: those of roscpp, librostime and libc.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_REAL_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_REAL_H

#include "libc/looked_up.h"

namespace move_base_abstract::shim {

/** @return the function that would be called if this library were not here; null if there is none.
 */
void* findReal(const char* symbol);

/** @return the same. Ends the process if there is none or replaced.def does not list the symbol. */
void* realOrAbort(const char* symbol);

/** @param symbol as the linker knows it and replaced.def lists it. */
template <typename Function>
Function* real(const char* symbol) {
  return reinterpret_cast<Function*>(realOrAbort(symbol));
}

/** @brief The same, looked up when it is first called. */
template <typename Function>
using Real = LookedUp<Function, realOrAbort>;

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_REAL_H
