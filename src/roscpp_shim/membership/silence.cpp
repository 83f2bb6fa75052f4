#include "silence.h"

#include <poll.h>
#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace move_base_abstract::lockstep::internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Nanoseconds kLooksPerLimit = 10;
constexpr Nanoseconds kMillisecond = kNanosecondsPerSecond / 1000;
constexpr Nanoseconds kLongestGap = 100;  // ms, wall; it may delay the end of a process
constexpr Nanoseconds kShortestGap = 1;   // ms, wall

}  // namespace

void SilenceWatch::begin(Nanoseconds limit, Granted granted, Tell tell) {
  if (limit < kNever && !thread_.joinable()) {
    thread_ = std::thread([this, limit, granted = std::move(granted), tell = std::move(tell)] {
      pthread_setname_np(pthread_self(), "lockstep_busy");
      watch(limit, granted, tell);
    });
  }
}

void SilenceWatch::end() {
  is_over_ = true;
  if (thread_.joinable()) {
    thread_.join();
  }
}

void SilenceWatch::watch(Nanoseconds limit, const Granted& granted, const Tell& tell) const {
  const auto gap = static_cast<int>(
      std::clamp(limit / kLooksPerLimit / kMillisecond, kShortestGap, kLongestGap));
  std::uint64_t round = 0, told = 0;
  Clock::time_point since = Clock::now();
  while (!is_over_) {
    ::poll(nullptr, 0, gap);
    const std::uint64_t now = granted();
    if (now != round) {
      round = now;
      since = Clock::now();
    } else if (round != 0 && round != told &&
               Clock::now() - since >= std::chrono::nanoseconds(limit)) {
      told = round;
      tell(round);
    }
  }
}

}  // namespace move_base_abstract::lockstep::internal
