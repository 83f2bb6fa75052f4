// Describes what a thread of this process is doing, for a user who wonders why it takes so long.
#pragma once

#include <string>

namespace move_base_abstract::lockstep::internal {

/**
 * @return the thread's name, whether it computes or in which system call it waits, and its
 * functions, the innermost last: "thread 'agent' computes: main in /path/agent+0x1a2b > plan() in
 * ...".
 *
 * The thread is asked by a signal. If it waits in a system call that a signal would end early, it
 * is not asked, and the text has no functions. Do not call this for the calling thread.
 *
 * @param id as gettid() gives it; for a thread that has ended, the text says that it has gone.
 */
std::string describeThread(int id);

/**
 * @return the same in short, for a label: "waits in accept of socket", or "computes, in
 * /path/agent+0x1a2b" with the innermost function of the program's own.
 */
std::string describeBriefly(int id);

}  // namespace move_base_abstract::lockstep::internal
