// How the program's threads wait, whatever they wait for.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_WAITS_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_WAITS_H

#include <functional>

#include "lockstep/wire/wire.h"
#include "turn.h"

namespace move_base_abstract::shim {

/**
 * @return whether a loop that waits for callbacks at @p caller only stores what comes into its
 * queue, which nobody else can get at, and is ended only by one who then joins its thread.
 */
using StoringLoops = bool (*)(const void* caller);

/** @brief How such loops are known, outside of spinners. For whoever knows a library with one. */
void setStoringLoops(StoringLoops is_storing);

/** @brief A thread that only looks, again and again, lets simulated time go on after @p limit
 * looks. */
void countLook(unsigned* count, unsigned limit);

/** @brief Let the others go first, of a thread that has the turn; in a loop time goes on. */
void giveWay();

/** @brief A sleep by the wall clock [ns], of a thread that has the turn. */
void sleepWall(Nanoseconds duration);

/**
 * @brief Wait until @p is_over, for at most @p lasts simulated ns (kNever: without end).
 * For a thread that has the turn; a wait without length is a look. @p what is shown of one without
 * end; it is owed by another thread, if it is not the end of one, @p end_of.
 */
Woken awaitCondition(const void* object, std::function<bool()> is_over, Nanoseconds lasts,
                     const char* what, const Task* end_of = nullptr);

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_WAITS_H
