#include "settings.h"

#include <cmath>

#include "clock/argument_check.h"
#include "clock/number_text.h"

namespace move_base_abstract {

Nanoseconds toNanoseconds(double seconds) {
  return std::llround(seconds * static_cast<double>(kNanosecondsPerSecond));
}

FactorUnits checkedLimit(double factor) {
  if (factor == 0.0) {
    return 0;
  }
  return std::llround(checkedFactor("limit", factor, " (or 0 for none)") *
                      static_cast<double>(kFactorUnit));
}

LockstepSettings checkedSettings(LockstepSettings settings) {
  if (settings.end_at != 0.0 && settings.end_at < settings.start_time) {
    refuse("end_at must be 0, or not before start_time, got " + numberText(settings.end_at));
  }
  if (settings.chaos_seed != 0 && settings.lookahead != 0.0) {
    refuse("chaos_seed must be 0 with a lookahead, where nothing is equal until it arrives; got " +
           std::to_string(settings.chaos_seed));
  }
  if (settings.chaos_seed == 0 && (settings.chaos_delay != 0.0 || settings.chaos_starts != 0.0 ||
                                   !settings.chaos_only.empty())) {
    refuse(
        "chaos_delay, chaos_starts and chaos_only must not be given without a chaos_seed other "
        "than 0");
  }
  return settings;
}

}  // namespace move_base_abstract
