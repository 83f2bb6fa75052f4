#include "failure.h"

#include <poll.h>
#include <ros/console.h>
#include <ros/init.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "stop_signals.h"

namespace move_base_abstract::lockstep::internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kOwnSignal{1};  // wall
constexpr int kLookMilliseconds = 10;          // wall

std::atomic<bool> has_failed{false};

void endWithError() {
  if (has_failed) {
    std::fflush(nullptr);
    std::_Exit(1);
  }
}

/**
 * Runs as soon as the library is loaded, so that endWithError() comes after everything that the
 * program does at its end.
 */
__attribute__((constructor)) void watchEnd() { std::atexit(endWithError); }

}  // namespace

void fail(const std::string& name, const std::string& reason) {
  has_failed = true;
  if (ros::isShuttingDown()) {  // the log may be closed already
    std::fprintf(stderr, "[FATAL] lockstep: the run is over for %s: %s\n", name.c_str(),
                 reason.c_str());
  } else {
    ROS_FATAL("lockstep: the run is over for %s: %s", name.c_str(), reason.c_str());
  }
}

bool awaitsOwnSignal() {
  const auto end = Clock::now() + kOwnSignal;
  while (ros::ok() && !stopSignalCame() && Clock::now() < end) {
    ::poll(nullptr, 0, kLookMilliseconds);
  }
  return !ros::ok() || stopSignalCame();
}

}  // namespace move_base_abstract::lockstep::internal
