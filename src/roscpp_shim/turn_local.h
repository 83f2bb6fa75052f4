// What each thread knows of itself. It is found without an allocation, because programs take locks
// and allocate memory before anything else has run.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_TURN_LOCAL_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_TURN_LOCAL_H

namespace move_base_abstract::shim {

struct Task;

struct TurnLocal {
  Task* task;         // its Task, if it is a thread of the program that has begun
  int inside;         // see Inside
  int beside;         // see Beside
  int starts;         // see StartsInternal
  bool is_internal;   // the thread is roscpp's or this library's own
  signed char first;  // 1: it is the process's first thread; -1: it is not; 0: not looked up
};

extern __thread TurnLocal t_local __attribute__((tls_model("initial-exec")));

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_TURN_LOCAL_H
