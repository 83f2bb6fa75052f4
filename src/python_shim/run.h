// The state of the run, which this library shares with Python. No ROS.
#pragma once

#include <sys/types.h>

#include <atomic>

#include "libc/instants.h"

namespace move_base_abstract::native {

using shim::kSecond;

/** Numbers in memory that Python reads and writes, too, in the order of machine/native.py. */
enum Cell {
  kNow,         // simulated time [ns]
  kSlept,       // how far clocks have gone on by themselves [ns]
  kDate,        // what clocks of dates show at simulated time 0 [ns]
  kUptime,      // the same for clocks that count from the machine's start
  kProcessor,   // the same for clocks of the processor
  kEpoch,       // a thread takes turns if it has entered at the present value of this number
  kIsFollowed,  // whether the program sees the run's time and chance
  kMayCall,     // whether Python can be called
  kNotices,     // number of notices
  kPatience,    // how long a thread may compute between two of its waits [ns of the processor]
  kTrouble,     // what makes addresses of objects differ from run to run: bits of Arenas::Trouble
  kCells
};

extern std::atomic<Nanoseconds> cells[kCells];

inline Nanoseconds cell(Cell which) { return cells[which].load(std::memory_order_relaxed); }

/** @brief What the calling code sees. */
enum class Sees {
  kMachine,  // the machine: it is Python itself, or works for it, or nothing is followed
  kRun,      // the run: the thread takes turns, so its calls have the same order in each run
  kStray     // the run, too, but the order of the thread's calls is not known
};

/** @return what the code at @p caller sees in the calling thread. For any thread, at any time. */
Sees sees(const void* caller);

/** @return whether the calling thread takes turns, so that what it does has one order in each run.
 */
bool hasTurns();

/** @brief Make Python sleep for @p duration [ns], as time.sleep() does; if it is negative, let
 * others go on. Only for a thread that sees kRun, and if mayCall().
 * @return false if the sleep was interrupted. */
bool sleepInPython(Nanoseconds duration);
inline bool mayCall() { return cell(kMayCall) != 0; }

/** @brief See move_base_abstract_native_crashes(). */
void tellOfCrashes(int socket, pid_t process, const char* bytes, size_t size);

/** @return the seed and the node's name, as one text. */
const char* seedText();

/** @brief Start libc's generators, and the bytes that replace the machine's, from that text. A
 * library may start libc's generators again from another number. */
void seedGenerators();

}  // namespace move_base_abstract::native

namespace native = move_base_abstract::native;
