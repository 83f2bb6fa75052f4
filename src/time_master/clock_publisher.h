// Publishes the simulated time of the event-driven clock on /clock, at a limited rate.
#pragma once

#include <ros/publisher.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "clock/scaled_clock.h"

namespace move_base_abstract {

/**
 * @brief Publishes the newest time, at once or as soon as the largest rate allows. While time
 * stands still, it repeats the last time, for nodes that start late or have missed a message.
 */
class ClockPublisher {
 public:
  /**
   * @param first the first time [ns, simulated]; 0: nothing is published before the first set().
   * @param largest_rate, repeat_rate [Hz, wall]
   */
  ClockPublisher(const ros::Publisher& publisher, Nanoseconds first, double largest_rate,
                 double repeat_rate);
  ~ClockPublisher();

  ClockPublisher(const ClockPublisher&) = delete;
  ClockPublisher& operator=(const ClockPublisher&) = delete;

  /**
   * @brief Set the simulated time [ns], which must be later than before. Any thread may call this;
   * it does not block.
   */
  void set(Nanoseconds time);

 private:
  using Clock = std::chrono::steady_clock;

  void run();
  bool awaitTime(std::unique_lock<std::mutex>& lock, Nanoseconds last);
  void publish(Nanoseconds time);

  ros::Publisher publisher_;
  const Clock::duration gap_;
  const Clock::duration repeat_gap_;
  std::atomic<Nanoseconds> time_;
  std::atomic<bool> waiting_{false};
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ending_ = false;
  std::thread thread_;  // last, as it uses the other members
};

}  // namespace move_base_abstract
