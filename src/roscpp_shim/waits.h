// How the program's threads wait, for anything.
#pragma once

#include <functional>

#include "lockstep/wire/wire.h"
#include "turn.h"

namespace move_base_abstract::shim {

/**
 * @return whether the loop at @p caller, which waits for callbacks, only stores the messages of its
 * queue. No other thread has access to that queue, and the thread that ends the loop then joins it.
 */
using StoringLoops = bool (*)(const void* caller);

/** @brief Set the function that recognises such loops; for code that knows a library with one. */
void setStoringLoops(StoringLoops is_storing);

/** @brief Let kPassage of simulated time pass in a loop of @p call, which names it for labels.
 * @pre The thread has the turn. */
void passTime(const char* call);

/** @brief Count a look of a thread that looks again and again without waiting. After @p limit looks
 * it lets simulated time go on. */
void countLook(unsigned* count, unsigned limit);

/** @brief Count that the calling thread, which has the turn, has read a clock. */
void countClockRead();

/**
 * @brief Count what a thread does again and again without waiting, for example questions.
 *
 * After @p limit times in a row, with at most @p slack of simulated time [ns] between two, it
 * counts as a loop that waits so, and each takes kPassage. @p call names it for labels.
 * @return whether this one has taken its time. @pre The thread has the turn.
 */
bool countRepeated(Repeated* done, unsigned limit, Nanoseconds slack, const char* call);

/** @brief Let the other threads go first; in a loop of @p call, time goes on. @pre The thread has
 * the turn. */
void giveWay(const char* call);

/** @brief Count a try to take a lock, if it was in vain. A loop of them gives way.
 * @return @p result. */
int tried(int result, bool is_vain);

/**
 * @brief Sleep until an instant of simulated time [ns], or, if the run ends before, until the node
 * has shut down.
 * @return whether the run goes on. @pre The thread has the turn.
 */
bool sleepUntil(Nanoseconds until);

/** @brief Sleep by the wall clock [ns]. @pre The thread has the turn. */
void sleepWall(Nanoseconds duration);

/**
 * @brief Wait until @p is_over, for at most @p lasts simulated ns (kNever: without end).
 *
 * If @p lasts is 0 or less, this only looks. @p what names a wait without end in the state. Another
 * thread owes it, unless the wait is for the end of the thread @p end_of.
 * @pre The thread has the turn.
 */
Woken awaitCondition(const void* object, std::function<bool()> is_over, Nanoseconds lasts,
                     const char* what, const Task* end_of = nullptr);

}  // namespace move_base_abstract::shim
