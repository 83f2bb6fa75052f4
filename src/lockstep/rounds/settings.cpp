#include "settings.h"

#include <cmath>
#include <set>

#include "clock/argument_check.h"
#include "clock/number_text.h"
#include "clock/time_master.h"

namespace move_base_abstract {

Nanoseconds toNanoseconds(double seconds) {
  return std::llround(seconds * static_cast<double>(kNanosecondsPerSecond));
}

FactorUnits checkedLimit(double factor) {
  if (factor == 0.0) {
    return 0;
  }
  return std::llround(checked("limit", factor, TimeMaster::kSmallestFactor,
                              TimeMaster::kLargestFactor,
                              " simulated seconds per wall second (or 0 for none)") *
                      static_cast<double>(kFactorUnit));
}

LockstepSettings checkedSettings(LockstepSettings settings) {
  checked("start_time", settings.start_time, 1e-6, 2e9, " s");
  checked("settle", settings.settle, 0.0, 3600.0, " s of wall time");
  if (settings.end_at != 0.0) {
    checked("end_at", settings.end_at, settings.start_time, 1e-9 * TimeMaster::kLastInstant,
            " s (or 0 for no end)");
  }
  if (settings.lookahead != 0.0) {
    checked("lookahead", settings.lookahead, 1e-6, 1000.0, " s (or 0 for none)");
  }
  if (settings.chaos_seed != 0 && settings.lookahead != 0.0) {
    refuse("chaos_seed must be 0 with a lookahead, where nothing is equal until it arrives; got " +
           std::to_string(settings.chaos_seed));
  }
  checked("chaos_delay", settings.chaos_delay, 0.0, 1000.0, " s");
  if (settings.chaos_seed == 0 && (settings.chaos_delay != 0.0 || !settings.chaos_only.empty())) {
    refuse("chaos_delay and chaos_only must not be given without a chaos_seed other than 0");
  }
  if (settings.silence_limit != 0.0) {
    checked("silence_limit", settings.silence_limit, 0.001, 86400.0,
            " s of wall time (or 0 for any)");
  }
  if (settings.max_microsteps < 1) {
    refuse("max_microsteps must be at least 1, got 0");
  }
  std::set<std::string> names;
  for (const std::string& name : settings.participants) {
    if (name.empty() || !names.insert(name).second) {
      refuse("participants must be names that differ, got '" + name + "'" +
             (name.empty() ? "" : " twice"));
    }
  }
  return settings;
}

}  // namespace move_base_abstract
