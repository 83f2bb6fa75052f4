#include "walked.h"

#include "clock/number_text.h"

namespace move_base_abstract {

std::deque<WalkedTurn> takeWalked(wire::Report& report,
                                  const std::shared_ptr<const std::string>& bytes,
                                  Nanoseconds begin, Nanoseconds end) {
  std::deque<WalkedTurn> turns;
  turns.push_back({begin, {bytes, {}}});
  for (wire::ReportItem& item : report.items) {
    const auto* const at = std::get_if<wire::At>(&item);
    if (at == nullptr) {
      turns.back().turn.items.push_back(item);
      continue;
    }
    if (at->time_ns < turns.back().at || at->time_ns >= end) {
      throw wire::MalformedFrame("AT must be from " + secondsText(turns.back().at) +
                                 " on and before the end of the window, " + secondsText(end) +
                                 ", got " + secondsText(at->time_ns));
    }
    turns.push_back({at->time_ns, {bytes, {}}});
  }
  report.items.clear();
  return turns;
}

}  // namespace move_base_abstract
