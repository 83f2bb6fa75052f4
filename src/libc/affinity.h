// What TBB sees of the computer's cores, of which it starts a thread for each but the first. These
// threads would take no turns. Both preloaded libraries use it. No ROS.
#pragma once

#include <dlfcn.h>
#include <sched.h>
#include <string.h>

#include <cstddef>

namespace move_base_abstract::shim {

/** @return whether @p caller is code of TBB. (Other libraries for loops and sums are told their
 * number of threads by the environment.) */
inline bool isTbb(const void* caller) {
  Dl_info info{};
  return dladdr(caller, &info) != 0 && info.dli_fname != nullptr &&
         strstr(info.dli_fname, "libtbb") != nullptr;
}

/** @brief Leave the first core in a set of @p size bytes. */
inline void keepFirst(std::size_t size, cpu_set_t* cores) {
  bool is_found = false;
  for (std::size_t k = 0; k < 8 * size; ++k) {
    if (CPU_ISSET_S(k, size, cores)) {
      if (is_found) {
        CPU_CLR_S(k, size, cores);
      }
      is_found = true;
    }
  }
}

}  // namespace move_base_abstract::shim
