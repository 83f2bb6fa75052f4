#include "starts.h"

#include <cstdint>

#include "clock/number_text.h"
#include "draws.h"

namespace move_base_abstract::chaos {
namespace {

constexpr std::uint64_t kShare = 2;  // one node of so many is late: each starts only once in a run
constexpr Nanoseconds kLinkShare = 10;  // a link is late by a tenth of the bound at most

}  // namespace

Nanoseconds Starts::ofNode(Nanoseconds now, const std::string& node) {
  const std::uint64_t link = mixed({hashOf("start"), hashOf(node)});
  const auto late =
      static_cast<Nanoseconds>(decisions_.draw(link, static_cast<std::uint64_t>(most_), kShare));
  if (late > 0) {
    decisions_.note(now, "start",
                    [&] { return node + " took " + secondsText(late) + " longer to start"; });
  }
  return late;
}

Nanoseconds Starts::ofLink(Nanoseconds now, std::string_view publisher, std::string_view subscriber,
                           std::string_view topic) {
  if (publisher == subscriber) {
    return 0;
  }
  const std::uint64_t link =
      mixed({hashOf("link"), hashOf(publisher), hashOf(subscriber), hashOf(topic)});
  const auto late = static_cast<Nanoseconds>(
      decisions_.draw(link, static_cast<std::uint64_t>(most_ / kLinkShare)));
  if (late > 0) {
    decisions_.note(now, "link", [&] {
      return "the connection of " + std::string(subscriber) + " to " + std::string(publisher) +
             "'s topic " + std::string(topic) + " took " + secondsText(late);
    });
  }
  return late;
}

}  // namespace move_base_abstract::chaos
