// The functions that this library stands in front of: roscpp's, librostime's and libc's own.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_REAL_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_REAL_H

namespace move_base_abstract::shim {

/** @return what would have been called if this library were not here; null if there is none. */
void* findReal(const char* symbol);

/** @return the same, of a symbol that replaced.def lists; else the process ends. */
void* realOrAbort(const char* symbol);

/** @param symbol as the linker knows it and replaced.def lists it. */
template <typename Function>
Function* real(const char* symbol) {
  return reinterpret_cast<Function*>(realOrAbort(symbol));
}

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_REAL_H
