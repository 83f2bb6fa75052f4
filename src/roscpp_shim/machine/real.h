// The real functions that this library replaces: those of roscpp, librostime and libc.
#pragma once

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

/**
 * @return the same, of a row of replaced.def. Ends the process if there is none, or no such row.
 * @param name of the row, without its arguments if it is the only one then; or its symbol.
 */
void* realOrAbort(const char* name);

template <typename Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(realOrAbort(name));
}

// The same, of the type of the function that replaces it. A member gets its object first.

template <typename Result, typename... Arguments>
auto* real(Result (* /*replacing*/)(Arguments...), const char* name) {
  return real<Result(Arguments...)>(name);
}
template <typename Result, typename... Arguments>
auto* real(Result (* /*replacing*/)(Arguments..., ...), const char* name) {
  return real<Result(Arguments..., ...)>(name);
}
template <typename Result, typename Class, typename... Arguments>
auto* real(Result (Class::* /*replacing*/)(Arguments...), const char* name) {
  return real<Result(Class*, Arguments...)>(name);
}
template <typename Result, typename Class, typename... Arguments>
auto* real(Result (Class::* /*replacing*/)(Arguments...) const, const char* name) {
  return real<Result(const Class*, Arguments...)>(name);
}

/** @brief The same, looked up when it is first called. */
template <typename Function>
using Real = LookedUp<Function, realOrAbort>;

}  // namespace move_base_abstract::shim

// Names for what stands outside of the namespace: functions of ROS and libc, and the headers of
// libc/, which ask this library for its policy.
namespace shim = move_base_abstract::shim;
namespace policy = shim;
