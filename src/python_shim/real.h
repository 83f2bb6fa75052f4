// The functions that this library stands in front of. No ROS.
#ifndef MOVE_BASE_ABSTRACT_PYTHON_SHIM_REAL_H
#define MOVE_BASE_ABSTRACT_PYTHON_SHIM_REAL_H

#include <atomic>

namespace move_base_abstract::native {

/** @return the function that would be called without this library; null if there is none. */
void* findReal(const char* symbol);

/** @brief A function that is looked up when it is first called. For any thread. */
template <typename Function>
class Real {
 public:
  explicit constexpr Real(const char* symbol) : symbol_(symbol) {}

  /** @return the function; null if this C library does not have it. */
  Function* get() {
    void* found = found_.load(std::memory_order_relaxed);
    if (found == nullptr) {
      found = findReal(symbol_);
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

}  // namespace move_base_abstract::native

/** The address from which the function was called in which this stands. */
#define MOVE_BASE_ABSTRACT_CALLER __builtin_return_address(0)

#endif  // MOVE_BASE_ABSTRACT_PYTHON_SHIM_REAL_H
