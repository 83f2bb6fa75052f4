// What Python says of the run, and what this library says to Python. No ROS.
#ifndef MOVE_BASE_ABSTRACT_PYTHON_SHIM_RUN_H
#define MOVE_BASE_ABSTRACT_PYTHON_SHIM_RUN_H

#include <atomic>

#include "roscpp_shim/machine/instants.h"

namespace move_base_abstract::native {

using shim::kSecond;

/** Numbers that Python reads and writes where they lie, in the order of machine/native.py. */
enum Cell {
  kNow,         // simulated time [ns]
  kSlept,       // by which clocks have gone on by themselves [ns]
  kDate,        // what clocks show at 0 [ns]: dates, ...
  kUptime,      // ... those that count from the machine's start, ...
  kProcessor,   // ... and of the processor
  kEpoch,       // whose threads have turns: those that have entered at the same number
  kIsFollowed,  // whether the program sees the run's time and chance
  kMayCall,     // whether Python can be called
  kNotices,     // how many things were noticed
  kPatience,    // how long a thread may compute between two of its waits [ns of the processor]
  kCells
};

extern std::atomic<Nanoseconds> cells[kCells];

inline Nanoseconds cell(Cell which) { return cells[which].load(std::memory_order_relaxed); }

/** @brief What a library sees that calls. */
enum class Sees {
  kMachine,  // it is Python itself, or works for it, or nothing is followed
  kRun,      // the thread has the turn: it does what it does in the same order in each run
  kStray     // the run's too, but nobody knows in which order
};

/** @return what the code at @p caller sees in the calling thread. For any thread, at any time. */
Sees sees(const void* caller);

/** @brief Have Python sleep [ns] as time.sleep() does; a negative number: let others go on.
 * @return false: the sleep was interrupted. For a thread that sees kRun, where mayCall(). */
bool sleepInPython(Nanoseconds duration);
inline bool mayCall() { return cell(kMayCall) != 0; }

/** @return the seed and the node's name. */
const char* seedText();

}  // namespace move_base_abstract::native

#endif  // MOVE_BASE_ABSTRACT_PYTHON_SHIM_RUN_H
