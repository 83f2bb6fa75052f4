// What cannot be followed, or only in some ways, as text.
#ifndef NATIVE_CALLS_H
#define NATIVE_CALLS_H

#include <string>

/** @return random bytes out of files, opened in each way that there is. */
std::string files();
/** @return what threads of the library draw by each generator, and what OpenMP's think it took. */
std::string strays();
/** @return "asked", when it has asked and done all that differs from run to run. */
std::string untold();

#endif  // NATIVE_CALLS_H
