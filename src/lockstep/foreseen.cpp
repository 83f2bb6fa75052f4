#include "foreseen.h"

#include <algorithm>

#include "clock/number_text.h"

namespace move_base_abstract {
namespace {

void check(const wire::At& at, const wire::Report& report, Nanoseconds after) {
  if (report.leaving) {
    throw wire::MalformedFrame("AT must not be in a last report");
  }
  if (at.time_ns <= after || at.time_ns >= report.next_ns) {
    throw wire::MalformedFrame("AT must be after " + secondsText(after) +
                               " and before the wake-up of its report, " +
                               secondsText(report.next_ns) + ", got " + secondsText(at.time_ns));
  }
}

}  // namespace

Foreseen takeForeseen(wire::Report& report, const std::shared_ptr<const std::string>& bytes,
                      Nanoseconds now) {
  Foreseen foreseen;
  const auto first = std::find_if(report.items.begin(), report.items.end(), [](const auto& item) {
    return std::holds_alternative<wire::At>(item);
  });
  for (auto item = first; item != report.items.end(); ++item) {
    if (const auto* at = std::get_if<wire::At>(&*item)) {
      check(*at, report, foreseen.instants.empty() ? now : foreseen.instants.back());
      foreseen.instants.push_back(at->time_ns);
      foreseen.turns.push_back({bytes, {}});
    } else if (std::holds_alternative<wire::Send>(*item)) {
      foreseen.turns.back().items.push_back(*item);
    } else {
      throw wire::MalformedFrame("after AT there must be SEND and AT only");
    }
  }
  report.items.erase(first, report.items.end());
  return foreseen;
}

}  // namespace move_base_abstract
