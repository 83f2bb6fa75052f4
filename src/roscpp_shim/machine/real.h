// The real functions that this library replaces: those of roscpp, librostime and libc.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_REAL_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_REAL_H

#include "libc/looked_up.h"

namespace move_base_abstract::shim {

/** @brief A row of replaced.def. */
struct Replaced {
  const char* library;  // "roscpp", "rostime", "libc", "libstdc++"
  const char* since;    // its first version in which the function is as expected
  const char* name;
  const char* symbol;  // as the linker knows it
};

constexpr Replaced kReplaced[] = {
#define REPLACED(library, since, name, symbol) {#library, since, name, #symbol},
#define REPLACED_C(library, since, symbol) {#library, since, #symbol "()", #symbol},
#include "replaced.def"
#undef REPLACED_C
#undef REPLACED
};

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

// The same, of the type of the function that replaces it. A member gets its object first.

template <typename Result, typename... Arguments>
auto* real(Result (* /*replacing*/)(Arguments...), const char* symbol) {
  return real<Result(Arguments...)>(symbol);
}
template <typename Result, typename... Arguments>
auto* real(Result (* /*replacing*/)(Arguments..., ...), const char* symbol) {
  return real<Result(Arguments..., ...)>(symbol);
}
template <typename Result, typename Class, typename... Arguments>
auto* real(Result (Class::* /*replacing*/)(Arguments...), const char* symbol) {
  return real<Result(Class*, Arguments...)>(symbol);
}
template <typename Result, typename Class, typename... Arguments>
auto* real(Result (Class::* /*replacing*/)(Arguments...) const, const char* symbol) {
  return real<Result(const Class*, Arguments...)>(symbol);
}

/** @brief The same, looked up when it is first called. */
template <typename Function>
using Real = LookedUp<Function, realOrAbort>;

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_REAL_H
