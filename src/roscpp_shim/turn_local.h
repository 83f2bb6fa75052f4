// What each thread knows of itself. It lies where no allocation is needed to find it: locks are
// taken, and memory is asked for, before anything else has run.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_TURN_LOCAL_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_TURN_LOCAL_H

namespace move_base_abstract::shim {

struct Task;

struct TurnLocal {
  Task* task;         // of a thread of the program that has begun
  int inside;         // see Inside
  int beside;         // see Beside
  int starts;         // see StartsInternal
  bool is_internal;   // the thread is roscpp's or this library's own
  signed char first;  // it is the process's first one: 1; another: -1; not looked up: 0
};

extern __thread TurnLocal t_local __attribute__((tls_model("initial-exec")));

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_TURN_LOCAL_H
