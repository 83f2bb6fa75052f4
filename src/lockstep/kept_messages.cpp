#include "kept_messages.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace move_base_abstract {

void KeptMessages::add(One message) {
  OfName& of_name = names_[message.name];
  message.number = ++count_;
  of_name.bytes += message.bytes.size();
  of_name.messages.push_back(std::move(message));
  while (of_name.messages.size() > most_ ||
         (of_name.bytes > kMostBytes && of_name.messages.size() > 1)) {
    of_name.bytes -= of_name.messages.front().bytes.size();
    of_name.messages.pop_front();
  }
}

std::vector<KeptMessages::One> KeptMessages::recent(std::string_view name, const std::string& node,
                                                    std::size_t most) const {
  std::vector<One> found;
  for (const auto& [key, of_name] : names_) {
    if (!name.empty() && name != key) {
      continue;
    }
    std::copy_if(of_name.messages.begin(), of_name.messages.end(), std::back_inserter(found),
                 [&](const One& message) {
                   return node.empty() || message.sender == node ||
                          std::count(message.receivers.begin(), message.receivers.end(), node) > 0;
                 });
  }
  std::sort(found.begin(), found.end(),
            [](const auto& one, const auto& other) { return one.number < other.number; });
  if (most != 0 && found.size() > most) {
    found.erase(found.begin(), found.end() - static_cast<std::ptrdiff_t>(most));
  }
  return found;
}

}  // namespace move_base_abstract
