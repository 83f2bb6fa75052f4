// Which clocks and random numbers the program sees: the machine's own, or those of the run. Labels
// the run if the program sees the machine's all the same.
#pragma once

#include <dlfcn.h>

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>

#include "libc/looked_up.h"

namespace move_base_abstract::shim {

/** @brief Whose clocks and random numbers a thread sees. */
enum class Sees {
  kMachine,  // the program is not in lockstep, or roscpp's or this library's code runs
  kRun,      // the thread does what it does in the same order in every run
  kStray     // the run's as well, but in an order that is not known, which labels the run
};

/** @return what the calling thread sees. Waits for its turn if it ran beside the others. */
Sees sees();

/** @return whether the program takes part now, and the calling thread has the turn. */
bool ordered();

/** @return whether addresses are to be the same in each run: the environment does not ask for
 * random ones, and the program is to take part. For any thread, before any constructor has run. */
bool hasOrderedAddresses();

/** @return the launcher's --seed. */
std::int64_t seed();
/** @return the text from which the program's random numbers follow: the seed and the node's name.
 */
const std::string& seedText();

/** @brief Call it when the program is about to join. */
void beginToFollow();
/** @brief Call it if the time master is not in lockstep. */
void stopFollowing();
/** @brief Send the labels and files that were noticed before the program joined. */
void tellWhatWasNoticed();

/** @brief Label the run, once for each @p what, with the place in the code of @p caller. If that is
 * null, the place is where the program's own code has called what leads here. */
void tell(const std::string& what, const void* caller);

/** @brief Report to the time master that the program has opened a file; @p path is its full path.
 */
void noteFile(const std::string& path, bool reads, bool writes);
/** @return the date at which the program has opened the file last to write it, by the clock that it
 * sees [ns]; nothing: never. */
std::optional<std::int64_t> whenWritten(const std::string& path);

/** @return the file of the code or data at @p address, and what else the linker knows; "": none. */
const char* fileOf(const void* address, Dl_info* info);
/** @return whether @p caller is code of a file with one of these texts in its path. */
bool isIn(const void* caller, std::initializer_list<const char*> names);
/** @return whether @p caller is code of roscpp, rosconsole or xmlrpcpp. */
bool isRoscpps(const void* caller);
/** @return whether @p caller is code of roscpp's timers, by its exported symbols. */
bool isTimers(const void* caller);
/** @return whether @p caller is code of a library of worker threads (OpenMP, TBB, ...), which wait
 * for each other in ways of their own; or the calling thread is one of them. */
bool isWorkerPool(const void* caller);
/** @return whether @p caller is code of the program or of a library of its own, not of a library
 * that came with the system. */
bool isProgramsOwn(const void* caller);

/** @brief Mark the calling thread as one of a library of worker threads. */
void becomeWorker();

/** @brief Counts a thread of the program that takes no turns, from when it is started until it has
 * ended. Any thread may construct it, and another one may destroy it. */
class WithoutTurns {
 public:
  WithoutTurns();
  ~WithoutTurns();
  WithoutTurns(const WithoutTurns&) = delete;
  WithoutTurns& operator=(const WithoutTurns&) = delete;
};

/**
 * @brief Call it where @p call, which is made again and again, lets time go on, or other threads.
 *
 * What is polled may be the work of a thread without turns, if there is one. Then the number of
 * polls is the machine's, and this labels the run.
 */
void tellPassage(const char* call);

}  // namespace move_base_abstract::shim
