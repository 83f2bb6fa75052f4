// What glibc's locks and conditions say of themselves in fields of their own; fit.cpp tries it out.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_GLIBC_FIELDS_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_GLIBC_FIELDS_H

#include <pthread.h>
#include <time.h>

namespace move_base_abstract::shim {

/** @return the thread (its tid) that holds @p mutex; 0: nobody does. */
inline int ownerOf(const pthread_mutex_t& mutex) { return mutex.__data.__owner; }

/** @return the clock by which @p condition's waits end. */
inline clockid_t clockOf(const pthread_cond_t& condition) {
  constexpr unsigned kMonotonic = 2;
  return (condition.__data.__wrefs & kMonotonic) != 0 ? CLOCK_MONOTONIC : CLOCK_REALTIME;
}

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_GLIBC_FIELDS_H
