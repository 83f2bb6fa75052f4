#include "order.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace move_base_abstract {
namespace {

bool isDigit(char c) { return c >= '0' && c <= '9'; }

/** @return the run of digits from @p at on, without leading zeros. @p at moves to its end. */
std::string_view takeNumber(std::string_view text, std::size_t& at) {
  while (at < text.size() && text[at] == '0') {
    ++at;
  }
  const std::size_t begin = at;
  while (at < text.size() && isDigit(text[at])) {
    ++at;
  }
  return text.substr(begin, at - begin);
}

/** @return less than 0, 0 or more than 0, if @p a is before, level with or after @p b. */
int compareNaturally(std::string_view a, std::string_view b) {
  std::size_t i = 0;
  std::size_t k = 0;
  while (i < a.size() && k < b.size()) {
    if (isDigit(a[i]) && isDigit(b[k])) {
      const std::string_view left = takeNumber(a, i);
      const std::string_view right = takeNumber(b, k);
      if (left.size() != right.size()) {
        return left.size() < right.size() ? -1 : 1;
      }
      if (const int order = left.compare(right); order != 0) {
        return order;
      }
    } else if (a[i] != b[k]) {
      return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[k]) ? -1 : 1;
    } else {
      ++i;
      ++k;
    }
  }
  if (i < a.size() || k < b.size()) {
    return i < a.size() ? 1 : -1;
  }
  return 0;
}

}  // namespace

bool naturalLess(std::string_view a, std::string_view b) {
  const int order = compareNaturally(a, b);
  return order != 0 ? order < 0 : a < b;  // "a01" and "a1" are level, but differ
}

bool isBefore(const MailOrder& a, const MailOrder& b) {
  if (a.rank != b.rank) {
    return a.rank < b.rank;
  }
  if (a.sub != b.sub) {
    return a.sub < b.sub;
  }
  if (a.place != b.place) {
    return a.place < b.place;
  }
  return a.number < b.number;
}

void NamePlaces::add(MemberId id, const std::string& name) {
  names_[id] = name;
  changed_ = true;
}

/** @brief Remove a name. The other places stay in order, so they need not be computed again. */
void NamePlaces::remove(MemberId id) {
  names_.erase(id);
  places_.erase(id);
}

std::uint32_t NamePlaces::of(MemberId id) const {
  arrange();
  const auto place = places_.find(id);
  return place == places_.end() ? 0 : place->second;
}

void NamePlaces::arrange() const {
  if (!changed_) {
    return;
  }
  changed_ = false;
  std::vector<std::pair<std::string_view, MemberId>> names;
  for (const auto& [id, name] : names_) {
    names.emplace_back(name, id);
  }
  std::sort(names.begin(), names.end(), [](const auto& a, const auto& b) {
    if (a.first != b.first) {
      return naturalLess(a.first, b.first);
    }
    return a.second < b.second;
  });
  std::uint32_t place = 0;
  for (const auto& [name, id] : names) {
    places_[id] = place++;
  }
}

}  // namespace move_base_abstract
