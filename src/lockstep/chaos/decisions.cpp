#include "decisions.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "draws.h"

namespace move_base_abstract::chaos {
namespace {

constexpr std::size_t kDigits = 12;
constexpr std::uint64_t kNames = (std::uint64_t{1} << (4 * kDigits)) - 1;
constexpr std::uint64_t kShares = 4;  // one choice of 2, 4, 8 or 16

}  // namespace

std::optional<std::set<std::uint64_t>> decisionsOf(const std::string& text) {
  if (text.empty()) {
    return std::nullopt;
  }
  std::set<std::uint64_t> numbers;
  std::size_t begin = text == "none" ? text.size() + 1 : 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    if (name.size() != kDigits || name.find_first_not_of("0123456789abcdef") != std::string::npos) {
      throw std::invalid_argument(
          "chaos_only must be names of decisions, 12 hexadecimal digits each, with commas between "
          "them, or none; got '" +
          name.substr(0, 100) + "'");
    }
    numbers.insert(std::strtoull(name.c_str(), nullptr, 16));
    begin = end + 1;
  }
  return numbers;
}

std::string nameOf(std::uint64_t number) {
  char text[kDigits + 1];
  std::snprintf(text, sizeof(text), "%012llx", static_cast<unsigned long long>(number & kNames));
  return text;
}

std::uint64_t Decisions::draw(std::uint64_t link, std::uint64_t most, std::uint64_t share) {
  const std::uint64_t choice = mixed({link, counts_[link]++});
  share = share != 0 ? share : std::uint64_t{2} << (mixed(seed_) % kShares);
  const std::uint64_t drawn = mixed({seed_, choice});
  latest_ = choice & kNames;
  if (most == 0 || drawn % share != 0 || (only_ && only_->count(latest_) == 0)) {
    return 0;
  }
  return 1 + mixed(drawn) % most;
}

void Decisions::note(Nanoseconds time, const char* what, const Said& says) {
  if (are_kept_) {
    taken_.push_back({nameOf(latest_), time, what, says()});
  }
}

}  // namespace move_base_abstract::chaos
