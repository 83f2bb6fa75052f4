// Which descriptors only the program itself can make ready: what it waits for then is its own.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_LIBC_OWN_DESCRIPTORS_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_LIBC_OWN_DESCRIPTORS_H

namespace move_base_abstract::shim {

/** @brief What is known of what a wait is for. */
struct WaitedFor {
  bool is_own = true;      // events, timers and pipes of the program
  bool has_timer = false;  // one of them is a timer

  void add(const WaitedFor& other);
};

/** @return what @p descriptor is. */
WaitedFor lookAt(int descriptor);

/** @return what is in the set of an epoll descriptor, as far as it came there by epoll_ctl(). */
WaitedFor membersOf(int set);

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_LIBC_OWN_DESCRIPTORS_H
