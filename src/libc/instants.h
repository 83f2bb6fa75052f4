// Conversions of times, and kinds of clocks. Both preloaded libraries use it, so it needs no ROS.
#pragma once

#include <time.h>

#include <cstdint>

namespace move_base_abstract {

using Nanoseconds = std::int64_t;

namespace shim {

constexpr Nanoseconds kSecond = 1'000'000'000;
constexpr Nanoseconds kMicrosecond = 1000;

/** Who only looks at something, again and again, waits for it. So time goes on by this [ns]. */
constexpr Nanoseconds kPassage = 1'000'000;
/** It does so after this many reads of clocks without another wait, */
constexpr unsigned kClockReads = 1000000;
/** and after as many more again: a program that has read so many does nothing else. */
constexpr unsigned kClockReadsAgain = 10000;

inline Nanoseconds toNs(const timespec& time) { return time.tv_sec * kSecond + time.tv_nsec; }
inline timespec toTimespec(Nanoseconds time) { return {time / kSecond, time % kSecond}; }

/** @return 0 for a clock that shows dates, 1 for a clock that counts from the machine's start. */
inline int indexOf(clockid_t clock) {
  return clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE || clock == CLOCK_TAI ? 0 : 1;
}

inline bool isOfProcessor(clockid_t clock) {
  return clock == CLOCK_PROCESS_CPUTIME_ID || clock == CLOCK_THREAD_CPUTIME_ID || clock < 0;
}

}  // namespace shim
}  // namespace move_base_abstract
