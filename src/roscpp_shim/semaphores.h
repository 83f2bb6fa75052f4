// How a thread sleeps and is woken: by libc's own semaphore, which does not hand the turn over.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_SEMAPHORES_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_SEMAPHORES_H

#include <semaphore.h>

#include "roscpp_shim/machine/real.h"
#include "turn.h"

namespace move_base_abstract::shim {

inline void awake(Task* task) {
  static auto* const post = real(&::sem_post, "sem_post");
  post(&task->go);
}

inline int awaitGo(Task* task) {
  static auto* const wait = real(&::sem_wait, "sem_wait");
  return wait(&task->go);
}

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_SEMAPHORES_H
