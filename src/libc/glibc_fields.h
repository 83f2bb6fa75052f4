// Private fields of glibc's locks and conditions; fit.cpp checks that they mean what is expected.
#pragma once

#include <pthread.h>
#include <time.h>

namespace move_base_abstract::shim {

/** @return the thread that holds @p mutex, by its tid; 0: none. */
inline int ownerOf(const pthread_mutex_t& mutex) { return mutex.__data.__owner; }

/** @return the clock by which waits for @p condition time out. */
inline clockid_t clockOf(const pthread_cond_t& condition) {
  constexpr unsigned kMonotonic = 2;
  return (condition.__data.__wrefs & kMonotonic) != 0 ? CLOCK_MONOTONIC : CLOCK_REALTIME;
}

}  // namespace move_base_abstract::shim
