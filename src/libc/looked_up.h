// The functions in front of which a preloaded library stands. Both preloaded libraries use it. No
// ROS, no allocations.
#pragma once

#include <dlfcn.h>

#include <atomic>
#include <initializer_list>

namespace move_base_abstract::shim {

/**
 * @return the function that would be called if this library were not here; null if there is none.
 *
 * If libc also has an older function of the same name, dlsym() may find that one. So the versions
 * of glibc's symbols are tried, the newest first.
 */
inline void* findNext(const char* symbol) {
  for (const char* version :
       {"GLIBC_2.36", "GLIBC_2.34", "GLIBC_2.30", "GLIBC_2.17", "GLIBC_2.3.2", "GLIBC_2.2.5"}) {
    void* const found = ::dlvsym(RTLD_NEXT, symbol, version);
    if (found != nullptr) {
      return found;
    }
  }
  return ::dlsym(RTLD_NEXT, symbol);
}

/** @brief A function that kFind looks up when it is first called. For any thread. */
template <typename Function, void* (*kFind)(const char*)>
class LookedUp {
 public:
  explicit constexpr LookedUp(const char* symbol) : symbol_(symbol) {}

  /** @return the function, as kFind gives it. */
  Function* get() {
    void* found = found_.load(std::memory_order_relaxed);
    if (found == nullptr) {
      found = kFind(symbol_);
      found_.store(found, std::memory_order_relaxed);
    }
    return reinterpret_cast<Function*>(found);
  }
  template <typename... Arguments>
  auto operator()(Arguments... arguments) {
    return get()(arguments...);
  }

 private:
  const char* symbol_;
  std::atomic<void*> found_{nullptr};
};

}  // namespace move_base_abstract::shim

/** The address from which the function was called in which this stands. */
#define MOVE_BASE_ABSTRACT_CALLER __builtin_return_address(0)
