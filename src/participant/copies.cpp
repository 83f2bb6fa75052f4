#include "copies.h"

#include <algorithm>
#include <functional>

namespace move_base_abstract::lockstep::internal {
namespace {

constexpr std::size_t kUnderWay = 64;  // the most copies under way when their sender leaves

}  // namespace

std::size_t Copies::digestOf(std::string_view message, bool has_header) {
  constexpr std::size_t kSequence = 4;  // bytes, the first of a header
  message.remove_prefix(has_header && message.size() >= kSequence ? kSequence : 0);
  return std::hash<std::string_view>()(message);
}

void Copies::delivered(const std::string& sender, std::size_t digest) {
  std::deque<std::size_t>& last = last_[sender];
  last.push_back(digest);
  if (last.size() > kUnderWay) {
    last.pop_front();
  }
}

bool Copies::isCopy(const std::string& sender, const Connection& connection, std::size_t digest) {
  if (connections_.count(connection) > 0) {
    return true;
  }
  const auto found = last_.find(sender);
  if (found == last_.end()) {
    return false;
  }
  std::deque<std::size_t>& last = found->second;
  const auto same = std::find(last.begin(), last.end(), digest);
  if (same == last.end()) {
    last_.erase(found);  // another node of this name, or the same one outside of lockstep
    return false;
  }
  last.erase(last.begin(), same + 1);  // copies come once each, and in this order
  return true;
}

}  // namespace move_base_abstract::lockstep::internal
