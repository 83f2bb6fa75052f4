#include "played.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>
#include <stdexcept>

#include "clock/little_endian.h"
#include "clock/number_text.h"

namespace move_base_abstract {
namespace {

constexpr std::size_t kSlotSize = 5;                                // bytes, in PLAY
constexpr std::array<std::size_t, 6> kSizes{4, 8, 56, 48, 56, 48};  // bytes, of each kind of slot

}  // namespace

bool Played::takeItem(const wire::ReportItem& item, const std::shared_ptr<const std::string>& frame,
                      Nanoseconds now, bool has_radio) {
  if (const auto* play = std::get_if<wire::Play>(&item)) {
    add(*play, frame, now);
    return true;
  }
  const auto* motion = std::get_if<wire::Motion>(&item);
  if (motion != nullptr) {
    move(*motion);
  }
  return motion != nullptr && (!has_radio || motion->sub >= wire::kOdometry);
}

void Played::takeUntil(Nanoseconds until, std::deque<WalkedTurn>* turns) {
  while (next() < until) {
    const Nanoseconds at = next();
    turns->push_back({at, take()});
  }
}

void Played::move(const wire::Motion& motion) {
  try {
    motions_.insert_or_assign(motion.sub, motion::Motion(motion.pieces));
  } catch (const std::invalid_argument& error) {
    throw wire::MalformedFrame(error.what());
  }
}

void Played::add(const wire::Play& play, const std::shared_ptr<const std::string>& frame,
                 Nanoseconds now) {
  if (play.first_ns <= now || play.period_ns <= 0) {
    throw wire::MalformedFrame("PLAY must begin after " + secondsText(now) +
                               ", with a period above 0 s, got " + secondsText(play.first_ns) +
                               " and " + secondsText(play.period_ns));
  }
  if (play.slots.size() % kSlotSize != 0) {
    throw wire::MalformedFrame("the slots of PLAY must have " + std::to_string(kSlotSize) +
                               " bytes each, got " + std::to_string(play.slots.size()));
  }
  Series series{play, {}};
  for (std::size_t begin = 0; begin < play.slots.size(); begin += kSlotSize) {
    series.slots.push_back(slotOf(play, begin));
  }
  frame_ = frame;
  due_.emplace_back(play.first_ns, series_.size());
  std::push_heap(due_.begin(), due_.end(), std::greater<>());
  series_.push_back(std::move(series));
}

Played::Slot Played::slotOf(const wire::Play& play, std::size_t begin) const {
  const auto kind = static_cast<unsigned char>(play.slots[begin]);
  const std::size_t place = numberAt<std::uint32_t>(&play.slots[begin + 1]);
  if (kind >= kSizes.size() || place + kSizes[kind] > play.payload.size()) {
    throw wire::MalformedFrame("a slot of PLAY must be of a known kind and within the " +
                               std::to_string(play.payload.size()) +
                               " bytes of the payload, got kind " + std::to_string(kind) + " at " +
                               std::to_string(place));
  }
  const bool is_odometry = kind >= static_cast<unsigned char>(wire::Slot::kOdomPose);
  const Slot slot{static_cast<wire::Slot>(kind), place,
                  play.sub + (is_odometry ? wire::kOdometry : 0)};
  const bool moves = slot.kind != wire::Slot::kNumber && slot.kind != wire::Slot::kStamp;
  if (moves && motions_.count(slot.mover) == 0) {
    throw wire::MalformedFrame("a pose in PLAY must be of a robot whose MOTION was told, got " +
                               std::to_string(slot.mover));
  }
  return slot;
}

PendingTurn Played::take() {
  const Nanoseconds now = next();
  const std::vector<Series*> due = takeDue(now);
  const std::size_t size = std::accumulate(
      due.begin(), due.end(), std::size_t{0},
      [](std::size_t sum, const Series* one) { return sum + one->play.payload.size(); });
  const auto bytes = std::make_shared<std::string>();
  bytes->reserve(size);  // so that what points into it stays valid
  PendingTurn turn{bytes, {}};
  for (Series* one : due) {
    const wire::Play& play = one->play;
    const std::size_t begin = bytes->size();
    bytes->append(play.payload);
    fill(&(*bytes)[begin], *one, now);
    ++one->play.number;
    turn.items.emplace_back(
        wire::Send{play.topic, play.sub, play.target, std::string_view(*bytes).substr(begin)});
  }
  return turn;
}

/** @return the series that are due at @p now, in their order; their next instants are noted. */
std::vector<Played::Series*> Played::takeDue(Nanoseconds now) {
  std::vector<Series*> due;
  std::set<std::pair<std::uint32_t, std::uint32_t>> once;  // topics and subs
  while (next() == now) {
    std::pop_heap(due_.begin(), due_.end(), std::greater<>());
    Series& series = series_[due_.back().second];
    due_.back().first = addSaturated(now, series.play.period_ns);
    std::push_heap(due_.begin(), due_.end(), std::greater<>());
    if (!series.play.once || once.emplace(series.play.topic, series.play.sub).second) {
      due.push_back(&series);
    }
  }
  return due;
}

/** @brief Write into a copy of the template, which is at @p bytes, what holds at @p now. */
void Played::fill(char* bytes, const Series& series, Nanoseconds now) const {
  for (const Slot& slot : series.slots) {
    char* const place = bytes + slot.place;
    if (slot.kind == wire::Slot::kNumber) {
      putNumber(place, series.play.number);
    } else if (slot.kind == wire::Slot::kStamp) {
      putNumber(place, static_cast<std::uint32_t>(now / kNanosecondsPerSecond));
      putNumber(place + 4, static_cast<std::uint32_t>(now % kNanosecondsPerSecond));
    } else if (slot.kind == wire::Slot::kPose || slot.kind == wire::Slot::kOdomPose) {
      const motion::Pose pose = motions_.at(slot.mover).poseAt(now);
      const double half = pose.yaw / 2.0;
      putNumber(place, pose.x);
      putNumber(place + 8, pose.y);
      putNumber(place + 40, std::sin(half));
      putNumber(place + 48, std::cos(half));
    } else {
      const motion::Velocity velocity = motions_.at(slot.mover).velocityAt(now);
      putNumber(place, velocity.forward);
      putNumber(place + 8, velocity.lateral);
      putNumber(place + 40, velocity.turning);
    }
  }
}

}  // namespace move_base_abstract
