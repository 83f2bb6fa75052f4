// What the launcher of unmodified programs has told this one. A program that is linked to this
// library tells it itself, and starts again.
#pragma once

namespace move_base_abstract::shim {

/** @brief Environment variables, as they were when the program began; nullptr: not set. */
struct Told {
  const char* chance;    // "SEED NODE_NAME", if the time master was in lockstep
  const char* sleep;     // "wall" or "simulated"
  const char* rank;      // a whole number
  const char* strict;    // set: the run ends at its first label
  const char* looks_on;  // set: the program takes no part
  const char* layout;    // "random": addresses need not be the same in each run
};

/** @return what was told. Any thread may ask, before any constructor has run. @pre libc has begun.
 */
const Told& told();

}  // namespace move_base_abstract::shim
