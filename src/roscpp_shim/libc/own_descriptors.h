// Which descriptors only the program itself can make ready.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_LIBC_OWN_DESCRIPTORS_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_LIBC_OWN_DESCRIPTORS_H

namespace move_base_abstract::shim {

/** @brief What is known about the descriptors of a wait. */
struct WaitedFor {
  bool is_own = true;      // only events, timers and pipes of the program
  bool has_timer = false;  // one of them is a timer

  void add(const WaitedFor& other);
};

/** @return what is known about @p descriptor. */
WaitedFor lookAt(int descriptor);

/** @return what is known about the members of an epoll descriptor, as epoll_ctl() added them. */
WaitedFor membersOf(int set);

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_LIBC_OWN_DESCRIPTORS_H
