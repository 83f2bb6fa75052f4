// What of the machine's time and chance the program is not to see, and what is told of what it sees
// of them all the same.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_FOLLOWED_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_FOLLOWED_H

#include <cstdint>
#include <string>

namespace move_base_abstract::shim {

/** @brief Whose clocks and random numbers a thread sees. */
enum class Sees {
  kMachine,  // the program is not in lockstep, or roscpp's or this library's code runs
  kRun,      // the thread does what it does in the same order in every run
  kStray     // the run's too, but nobody knows in which order: that is told
};

/** @return what the calling thread sees; waits for its turn where it ran beside the others. */
Sees sees();

/** @return whether the program takes part now, and the calling thread has the turn. */
bool ordered();

/** @return whether addresses are to be the same in each run: the environment does not ask for
 * random ones, and the program is followed. For any thread, before any constructor has run. */
bool hasOrderedAddresses();

/** @return the launcher's --seed. */
std::int64_t seed();
/** @return what the program's random numbers start from: the seed and the node's name. */
const std::string& seedText();

/** @brief The program is about to join, or finds that the time master is not in lockstep. */
void beginToFollow();
void stopFollowing();
/** @brief It has joined: what was noticed before is told now. */
void tellWhatWasNoticed();

/** @brief Label the run, once for each @p what, with the place that @p caller lies in. */
void tell(const std::string& what, const void* caller);

/** @brief Tell the time master of a file, by its full path, that the program has opened. */
void noteFile(const std::string& path, bool reads, bool writes);

/** @return whether code of roscpp, its console or its XML-RPC calls. */
bool isRoscpps(const void* caller);
/** @return whether code of roscpp's timers, as its exported symbols say. */
bool isTimers(const void* caller);
/** @return whether a library of worker threads calls: they wait for each other in ways of their
 * own. */
bool isWorkerPool(const void* caller);
/** @return whether the program or a library of its own calls, none that came with the system. */
bool isProgramsOwn(const void* caller);

/** @brief The calling thread is one of a library of worker threads. */
void becomeWorker();

}  // namespace move_base_abstract::shim

/** Who has called the function that this stands in. */
#define MOVE_BASE_ABSTRACT_CALLER __builtin_return_address(0)

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_FOLLOWED_H
