// The cores that this process may use by itself. While it takes part, the time master may keep it
// on one core.
#pragma once

#include <sched.h>

namespace move_base_abstract::shim {

/** @brief While this object lives, what the calling thread starts has the process's own cores. */
class OwnCores {
 public:
  OwnCores();
  ~OwnCores();
  OwnCores(const OwnCores&) = delete;
  OwnCores& operator=(const OwnCores&) = delete;
  /** @brief Keep the own cores also afterwards, in the child of a fork. */
  void keep() { is_lifted_ = false; }

 private:
  cpu_set_t bound_;
  bool is_lifted_ = false;
};

}  // namespace move_base_abstract::shim
