#include "clock_publisher.h"

#include <rosgraph_msgs/Clock.h>

#include "time_mode.h"

namespace move_base_abstract {
namespace {

std::chrono::steady_clock::duration gapOf(double rate) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rate));
}

}  // namespace

ClockPublisher::ClockPublisher(const ros::Publisher& publisher, Nanoseconds first,
                               double largest_rate, double repeat_rate)
    : publisher_(publisher),
      gap_(gapOf(largest_rate)),
      repeat_gap_(gapOf(repeat_rate)),
      time_(first),
      thread_([this] { run(); }) {}

ClockPublisher::~ClockPublisher() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void ClockPublisher::set(Nanoseconds time) {
  time_ = time;
  // The lock is taken only if the thread sleeps, not for each of thousands of leaps per second.
  if (waiting_) {
    const std::lock_guard<std::mutex> lock(mutex_);
    wake_.notify_all();
  }
}

void ClockPublisher::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  Nanoseconds last = 0;
  while (awaitTime(lock, last)) {
    last = time_;
    const auto published = Clock::now();
    lock.unlock();
    publish(last);
    lock.lock();
    wake_.wait_until(lock, published + gap_, [this] { return ending_; });
  }
  if (time_ != last) {
    publish(time_);  // the last time of the run
  }
}

/**
 * @brief Wait for another time than @p last, or until @p last is to be repeated. @return false at
 * the end.
 */
bool ClockPublisher::awaitTime(std::unique_lock<std::mutex>& lock, Nanoseconds last) {
  const auto due = Clock::now() + repeat_gap_;
  const auto news = [&] { return ending_ || time_ != last; };
  waiting_ = true;  // before time_ is read, so that a later set() sees it
  if (last == 0) {
    wake_.wait(lock, news);
  } else {
    wake_.wait_until(lock, due, news);
  }
  waiting_ = false;
  return !ending_;
}

void ClockPublisher::publish(Nanoseconds time) {
  rosgraph_msgs::Clock message;
  message.clock = toRos(time);
  publisher_.publish(message);
}

}  // namespace move_base_abstract
