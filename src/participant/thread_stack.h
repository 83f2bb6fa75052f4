// What a thread of this process is doing, in words, for whoever wonders why it takes so long.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_THREAD_STACK_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_THREAD_STACK_H

#include <string>

namespace move_base_abstract::lockstep::internal {

/**
 * @brief Its name, whether it computes or which call of the system it waits in, and its functions,
 * the innermost last: "thread 'agent' computes: main in /path/agent+0x1a2b > plan() in ...".
 *
 * The thread is asked by a signal. One that waits in a call which a signal would end early is not
 * asked: the call is all that is said then. Not for the thread itself.
 *
 * @param id as gettid() says; a thread that has gone is named as gone
 */
std::string describeThread(int id);

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_THREAD_STACK_H
