#include "window.h"

#include <algorithm>
#include <variant>

namespace move_base_abstract::lockstep::internal {
namespace {

// More turns at one instant are left to the time master, which recognizes a zero-delay loop.
constexpr unsigned kMostRepeats = 100;
constexpr std::size_t kLength = 4;  // bytes of a frame before its type

}  // namespace

bool Window::take(wire::Grant* grant) {
  auto& items = grant->items;
  const auto* const window = items.empty() ? nullptr : std::get_if<wire::Window>(&items.front());
  is_open_ = window != nullptr;
  if (!is_open_) {
    return false;
  }
  end_ = window->end_ns;
  lookahead_ = window->lookahead_ns;
  repeats_ = 0;
  const auto first = std::find_if(items.begin(), items.end(), [](const auto& item) {
    return std::holds_alternative<wire::Arrives>(item);
  });
  for (auto item = first; item != items.end();) {
    wire::Grant one;
    one.time_ns = std::get<wire::Arrives>(*item).time_ns;
    for (++item; item != items.end() && !std::holds_alternative<wire::Arrives>(*item); ++item) {
      one.items.push_back(*item);
    }
    arrivals_.push_back({one.time_ns, wire::encode(wire::MasterFrame(one)).substr(kLength)});
  }
  items.erase(first, items.end());
  items.erase(items.begin());
  return true;
}

Nanoseconds Window::next(Nanoseconds wish, Nanoseconds now) {
  const Nanoseconds next = std::max(now, std::min(wish, firstArrival()));
  repeats_ = next == now ? repeats_ + 1 : 0;
  return is_open_ && next < end_ && repeats_ <= kMostRepeats ? next : kNever;
}

std::string Window::arrived(Nanoseconds now) {
  if (firstArrival() > now) {
    return "";
  }
  std::string frame = std::move(arrivals_.front().frame);
  arrivals_.pop_front();
  return frame;
}

}  // namespace move_base_abstract::lockstep::internal
