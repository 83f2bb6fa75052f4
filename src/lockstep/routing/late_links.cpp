#include "late_links.h"

namespace move_base_abstract {

void LateLinks::add(Nanoseconds due, const LateLink& late) {
  const Place place(due, count_++);
  links_.emplace(place, late);
  places_.emplace(late.link, place);
}

bool LateLinks::forget(const Link& link) {
  const auto place = places_.find(link);
  if (place == places_.end()) {
    return false;
  }
  links_.erase(place->second);
  places_.erase(place);
  return true;
}

LateLink LateLinks::take() {
  const LateLink late = links_.begin()->second;
  forget(late.link);
  return late;
}

}  // namespace move_base_abstract
