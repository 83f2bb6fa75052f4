#include "core_choice.h"

#include <algorithm>

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kMillisecond = kNanosecondsPerSecond / 1000;
constexpr std::uint64_t kRoundsBefore = 32;  // at the beginning of a run, before the first look
constexpr std::uint64_t kSpanRounds = 48;
constexpr Nanoseconds kSpanTime = 8 * kMillisecond;
constexpr std::uint64_t kLongSpanRounds = 2;  // if rounds are long
constexpr Nanoseconds kLongSpanTime = 100 * kMillisecond;
constexpr std::size_t kFewestPairs = 3;
constexpr std::size_t kMostPairs = 12;
constexpr double kGain = 0.05;      // a smaller gain does not count
constexpr double kOtherCost = 1.5;  // a cost this many times higher or lower has changed
constexpr double kKnownShare = 0.5;
constexpr Nanoseconds kWindow = 100 * kMillisecond;  // in which rounds are added up to compare
constexpr Nanoseconds kShortestGap = kNanosecondsPerSecond;
constexpr Nanoseconds kLongestGap = 16 * kNanosecondsPerSecond;
constexpr Nanoseconds kSoonest = kNanosecondsPerSecond / 4;
constexpr double kLostShare = 0.02;  // of the time, which looks may cost
constexpr std::uint64_t kAlternateRounds = 10;
constexpr std::size_t kNoPair = static_cast<std::size_t>(-1);

std::size_t cellOf(std::size_t grants) {
  std::size_t cell = std::min<std::size_t>(grants, 8);
  for (std::size_t rest = grants; rest > 8 && cell < 15; rest /= 2) {
    ++cell;
  }
  return cell;
}

}  // namespace

// ---- costs -----------------------------------------------------------------------------------

void RoundCosts::add(std::size_t grants, Nanoseconds duration) {
  Cell& cell = cells_[cellOf(grants)];
  ++cell.rounds;
  cell.time += duration;
  ++rounds_;
  time_ += duration;
}

RoundCosts& RoundCosts::operator+=(const RoundCosts& other) {
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    cells_[k].rounds += other.cells_[k].rounds;
    cells_[k].time += other.cells_[k].time;
  }
  rounds_ += other.rounds_;
  time_ += other.time_;
  return *this;
}

double RoundCosts::relativeTo(const RoundCosts& others) const {
  double own = 0.0;
  double other = 0.0;
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const Cell& a = cells_[k];
    const Cell& b = others.cells_[k];
    if (a.rounds > 0 && b.rounds > 0) {
      const auto weight = static_cast<double>(a.rounds + b.rounds);
      own += weight * static_cast<double>(a.time) / static_cast<double>(a.rounds);
      other += weight * static_cast<double>(b.time) / static_cast<double>(b.rounds);
    }
  }
  return other > 0.0 ? own / other : 0.0;
}

double RoundCosts::shareIn(const RoundCosts& others) const {
  Nanoseconds known = 0;
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    known += others.cells_[k].rounds > 0 ? cells_[k].time : 0;
  }
  return time_ > 0 ? static_cast<double>(known) / static_cast<double>(time_) : 1.0;
}

// ---- the choice ------------------------------------------------------------------------------

void CoreChoice::add(std::size_t grants, Nanoseconds duration, Nanoseconds wall) {
  ++rounds_;
  if (wish_ == CoresWish::kAlternate && rounds_ % kAlternateRounds == 0) {
    is_one_ = !is_one_;
  } else if (wish_ == CoresWish::kAuto && is_looking_) {
    look(grants, duration, wall);
  } else if (wish_ == CoresWish::kAuto) {
    watch(grants, duration, wall);
  }
}

/**
 * @brief Begin a look when it is due, or when the cost of rounds differs from that of the latest
 * look.
 */
void CoreChoice::watch(std::size_t grants, Nanoseconds duration, Nanoseconds wall) {
  if (rounds_ <= kRoundsBefore) {
    return;
  }
  lately_.add(grants, duration);
  bool is_other = false;
  is_dearer_ = false;
  if (lately_.time() >= kWindow && lately_.rounds() >= kLongSpanRounds) {
    const double cost = lately_.relativeTo(kept_);
    const bool is_unknown = lately_.shareIn(kept_) < kKnownShare;
    is_dearer_ = is_unknown || cost > kOtherCost;
    is_other = is_dearer_ || cost < 1.0 / kOtherCost;
    lately_ = RoundCosts();
  }
  if (wall >= due_ || (is_other && wall >= earliest_)) {
    beginLook();
  }
}

void CoreChoice::beginLook() {
  is_looking_ = true;
  is_second_ = false;
  is_fresh_ = false;
  spent_ = 0;
  span_ = RoundCosts();
  pairs_.assign(1, Pair());
}

void CoreChoice::use(bool one) {
  is_fresh_ = one != is_one_;
  is_one_ = one;
  span_ = RoundCosts();
}

/**
 * @brief Add a round to the look under way. The order of the spans is kept, other, other, kept,
 * kept, ...: that takes fewer changes.
 */
void CoreChoice::look(std::size_t grants, Nanoseconds duration, Nanoseconds wall) {
  spent_ += duration;
  if (is_fresh_) {
    is_fresh_ = false;  // its caches are cold
    return;
  }
  span_.add(grants, duration);
  const bool is_over = (span_.rounds() >= kSpanRounds && span_.time() >= kSpanTime) ||
                       (span_.rounds() >= kLongSpanRounds && span_.time() >= kLongSpanTime);
  if (!is_over) {
    return;
  }
  (is_one_ ? pairs_.back().one : pairs_.back().all) += span_;
  if (!is_second_) {
    is_second_ = true;
    use(!is_one_);
  } else if (isClear() || pairs_.size() >= kMostPairs) {
    settle(wall);
  } else {
    is_second_ = false;
    pairs_.emplace_back();
    use(is_one_);
  }
}

CoreChoice::Better CoreChoice::better(double cost_of_one) {
  if (cost_of_one <= 0.0) {
    return Better::kNeither;  // no rounds can be compared
  }
  return cost_of_one < 1.0 - kGain   ? Better::kOne
         : cost_of_one > 1.0 + kGain ? Better::kAll
                                     : Better::kNeither;
}

/**
 * @return the cost of rounds on one core relative to all cores, over all pairs except @p without.
 */
double CoreChoice::costOfOne(std::size_t without) const {
  Pair sum;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    if (k != without) {
      sum.one += pairs_[k].one;
      sum.all += pairs_[k].all;
    }
  }
  return sum.one.relativeTo(sum.all);
}

bool CoreChoice::isClear() const {
  if (pairs_.size() < kFewestPairs) {
    return false;
  }
  const Better all_say = better(costOfOne(kNoPair));
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    if (better(costOfOne(k)) != all_say) {
      return false;
    }
  }
  return true;
}

void CoreChoice::settle(Nanoseconds wall) {
  const double cost = costOfOne(kNoPair);
  const Better winner = isClear() ? better(cost) : Better::kNeither;
  const bool one = winner == Better::kNeither ? keeps_one_ : winner == Better::kOne;
  RoundCosts kept;
  RoundCosts other;
  for (const Pair& pair : pairs_) {
    kept += one ? pair.one : pair.all;
    other += one ? pair.all : pair.one;
  }
  const double gain = std::max(1.0, other.relativeTo(kept));
  const double needed = static_cast<double>(kept.time()) + static_cast<double>(other.time()) / gain;
  const double lost = std::max(0.0, static_cast<double>(spent_) - needed);
  const auto paid = static_cast<Nanoseconds>(lost / kLostShare);
  gap_ = one == keeps_one_ && gap_ > 0 ? std::min(2 * gap_, kLongestGap) : kShortestGap;
  due_ = wall + std::max(gap_, paid);
  earliest_ = wall + std::max(kSoonest, paid);
  keeps_one_ = one;
  kept_ = kept;
  lately_ = RoundCosts();
  is_looking_ = false;
  is_dearer_ = false;
  use(one);
}

}  // namespace move_base_abstract
