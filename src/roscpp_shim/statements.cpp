// The function that move_base_abstract/properties.h finds by its name: it logs events.
#include "node.h"
#include "turn.h"

/** @return 0: the row is in the report; 1: the program does not take part. */
extern "C" __attribute__((visibility("default"))) int move_base_abstract_log_row(
    const char* kind, const char* values) {
  using namespace move_base_abstract;
  if (!shim::takesPart() || !shim::turn().enter()) {
    return 1;
  }
  const shim::Inside inside;
  shim::node().append(wire::Log{0, shim::node().membership().name(), kind, values});
  return 0;
}
