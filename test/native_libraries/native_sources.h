// What a user's library in C asks the machine, as text: it knows nothing of lockstep.
#ifndef NATIVE_SOURCES_H
#define NATIVE_SOURCES_H

#include <string>

/** @return what it has found out about @p topic: clocks, sleeps, waits, timed, given, chance,
 * seconds, spin, limit, threads, files, strays or untold. */
std::string ask(const std::string& topic);

#endif  // NATIVE_SOURCES_H
