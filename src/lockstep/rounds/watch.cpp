#include "watch.h"

#include <algorithm>

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kLongReport = kNanosecondsPerSecond;  // a longer one is shown as waiting

}  // namespace

std::vector<MemberId>& RoundWatch::begin(Nanoseconds wall) {
  next_look_ = limit_ == 0 ? kNever : addSaturated(wall, limit_);
  granted_.clear();
  return granted_;
}

std::vector<MemberId> RoundWatch::look(Nanoseconds wall) {
  std::vector<MemberId> silent;
  if (wall < next_look_ || members_.owing() == 0) {
    return silent;
  }
  next_look_ = kNever;
  for (const MemberId id : granted_) {
    MemberState* const member = members_.find(id);
    if (member == nullptr || !member->owes) {
      continue;
    }
    member->silence_told = true;
    silent.push_back(id);
  }
  return silent;
}

bool RoundWatch::isLong(Nanoseconds wall) const {
  return std::any_of(granted_.begin(), granted_.end(), [this, wall](MemberId id) {
    const MemberState* const member = members_.find(id);
    return member && member->owes && wall - member->granted_wall > kLongReport;
  });
}

}  // namespace move_base_abstract
