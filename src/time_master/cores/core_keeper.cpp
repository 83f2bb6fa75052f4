#include "core_keeper.h"

#include <cmath>

#include "time_master/wall_now.h"

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kMillisecond = kNanosecondsPerSecond / 1000;
// A participant that works for so long may need a core for itself, or have several threads: a round
// that only handles messages takes less.
constexpr Nanoseconds kLongRound = 20 * kMillisecond;
constexpr Nanoseconds kFreeCoreGap = kNanosecondsPerSecond;
constexpr Nanoseconds kChildrenGap = 500 * kMillisecond;  // a look takes about 1 ms
constexpr Nanoseconds kWork =
    2 * kMillisecond;  // of one participant in a round; messages take less
constexpr Nanoseconds kTellingTime = kNanosecondsPerSecond;
constexpr double kMuchWork = 0.5;

}  // namespace

void CoreKeeper::join(pid_t process) {
  if (!is_over_ && process > 0) {
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
  if (is_over_) {
    return;
  }
  const bool is_next = rounds != round_;
  if (grants_ > 0 && (is_next || owing == 0)) {
    finishRound(wall);
  }
  if (is_next) {
    round_ = rounds;
    grants_ = owing;
    begun_ = beginRound(wall);
  } else if (grants_ > 0 && wall >= due()) {
    binding_.release();  // for the rest of this round
  }
}

void CoreKeeper::finishRound(Nanoseconds wall) {
  const Nanoseconds duration = wall - begun_;
  if (binding_.claimed().number() >= 0) {
    in_rounds_ += duration;
    const bool is_common_work =
        grants_ > 1 && duration >= static_cast<Nanoseconds>(grants_) * kWork;
    in_common_work_ += is_common_work ? duration : 0;
  }
  grants_ = 0;
  if (binding_.isBound() && wall >= children_due_) {
    binding_.freeChildren();
    children_due_ = wall + kChildrenGap;
  }
}

/**
 * @brief Bind the processes that are not bound.
 * @return the wall instant at which the round begins.
 */
Nanoseconds CoreKeeper::beginRound(Nanoseconds wall) {
  const bool looks = binding_.claimed().isShared() && wall >= free_core_due_;
  if (binding_.isBound() && !is_new_ && !looks) {
    return wall;
  }
  binding_.bind(looks);
  free_core_due_ = wallNow() + kFreeCoreGap;
  is_new_ = false;
  return wallNow();
}

Nanoseconds CoreKeeper::due() const {
  return binding_.isBound() && grants_ > 0 ? begun_ + kLongRound : kNever;
}

void CoreKeeper::end() {
  binding_.leaveCore();
  is_over_ = true;
}

std::string CoreKeeper::text() const {
  const ClaimedCore& core = binding_.claimed();
  if (core.number() < 0) {
    return "all";
  }
  const double share = static_cast<double>(in_common_work_) / static_cast<double>(in_rounds_ + 1);
  const bool is_much = in_rounds_ >= kTellingTime && share >= kMuchWork;
  return "one (core " + std::to_string(core.number()) +
         (core.isShared() ? ", shared with other runs)" : ")") +
         (is_much ? "; for " + std::to_string(std::lround(100.0 * share)) +
                        " % of the time several nodes compute for milliseconds at one instant: "
                        "`cores: all` may be faster"
                  : "");
}

}  // namespace move_base_abstract
