#include "core_keeper.h"

#include "time_master/wall_now.h"

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kMillisecond = kNanosecondsPerSecond / 1000;
// A participant that works for so long may need a core for itself, or have several threads: a round
// that only handles messages takes less. With a lookahead a core may have several to work off.
constexpr Nanoseconds kLongRound = 20 * kMillisecond;
constexpr Nanoseconds kCoreGap = kNanosecondsPerSecond;
constexpr Nanoseconds kChildrenGap = 500 * kMillisecond;  // a look takes about 1 ms

}  // namespace

CoreKeeper::CoreKeeper(CoresWish wish, bool has_lookahead)
    : wish_(wish),
      layout_(has_lookahead && wish != CoresWish::kOne ? CoreLayout::kApart
                                                       : CoreLayout::kTogether),
      choice_(wish),
      binding_(layout_) {}

void CoreKeeper::join(pid_t process) {
  if (isWatched() && process > 0) {
    binding_.add(process);
    is_new_ = true;
  }
}

void CoreKeeper::leave(pid_t process) {
  if (process > 0) {
    binding_.remove(process);
  }
}

void CoreKeeper::follow(std::uint64_t rounds, std::size_t owing, Nanoseconds wall) {
  if (!isWatched()) {
    return;
  }
  const bool is_next = rounds != round_;
  if (grants_ > 0 && (is_next || owing == 0)) {
    finishRound(wall);
  }
  if (is_next) {
    round_ = rounds;
    grants_ = owing;
    const bool was_bound = binding_.isBound();
    apply();
    begun_ = binding_.isBound() == was_bound ? wall : wallNow();
  } else if (grants_ > 0 && wall >= due()) {
    binding_.release();  // for the rest of this round
  }
}

void CoreKeeper::finishRound(Nanoseconds wall) {
  const std::size_t grants = grants_;
  grants_ = 0;
  if (!binding_.hasChoice()) {
    return;
  }
  const bool was_looking = choice_.isLooking();
  choice_.add(grants, wall - begun_, wall);
  if (choice_.isLooking() && !was_looking) {
    binding_.measureWork();
    if (choice_.isDearer()) {
      binding_.leaveCores();  // another program may work there now
    }
  }
  if (binding_.isBound() && wall >= children_due_) {
    binding_.freeChildren();
    children_due_ = wall + kChildrenGap;
  }
}

/** @brief Bind or release the processes as the choice says. */
void CoreKeeper::apply() {
  const bool is_wanted = choice_.isOne() && binding_.hasChoice();
  if (is_wanted == binding_.isBound() && !(is_wanted && is_new_)) {
    return;
  }
  const Nanoseconds begin = wallNow();
  if (!is_wanted) {
    binding_.release();
  } else if (begin >= core_due_) {
    core_due_ = binding_.bind(wish_ != CoresWish::kAuto) ? 0 : begin + kCoreGap;
    is_new_ = false;
  }
  if (wish_ == CoresWish::kAuto && !choice_.isLooking() && !choice_.isOne()) {
    binding_.leaveCores();  // for other runs
  }
  choice_.addChange(wallNow() - begin);
}

Nanoseconds CoreKeeper::due() const {
  const bool may_free = wish_ != CoresWish::kOne && binding_.isBound() && grants_ > 0;
  const auto at_once = static_cast<Nanoseconds>(isApart() ? grants_ : 1);
  return may_free ? begun_ + at_once * kLongRound : kNever;
}

void CoreKeeper::end() {
  binding_.leaveCores();
  is_over_ = true;
}

std::string CoreKeeper::text() const {
  const bool is_one = wish_ == CoresWish::kAuto ? choice_.keepsOne() : choice_.isOne();
  if (!is_one || is_over_ || binding_.cores().empty()) {
    return "all";
  }
  std::string numbers;
  for (const int core : binding_.cores()) {
    numbers += (numbers.empty() ? "" : ", ") + std::to_string(core);
  }
  return isApart() ? "one each (cores " + numbers + ")" : "one (core " + numbers + ")";
}

}  // namespace move_base_abstract
