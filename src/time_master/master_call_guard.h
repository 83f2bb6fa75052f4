// Ends the process if a call to a ROS master that has gone would block it for ever.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace move_base_abstract {

/**
 * @brief Guards calls of roscpp to the ROS master. Such a call never returns if the master dies
 * during it, and roscpp repeats it for ever if the master has died before.
 *
 * The guard works while a Section exists. If the master refuses connections three times in a row (a
 * wall second apart), or 3 s have passed since a signal told the process to end, the guard logs
 * this and ends the process with code 1. A section must not have data that would be lost then.
 */
class MasterCallGuard {
 public:
  /** @brief Call this after ros::init. @param signal_number not 0: the process was told to end. */
  explicit MasterCallGuard(const std::atomic<int>& signal_number);
  ~MasterCallGuard();
  MasterCallGuard(const MasterCallGuard&) = delete;
  MasterCallGuard& operator=(const MasterCallGuard&) = delete;

  /**
   * @brief Wait for the ROS master. @return false if a signal told the process to end meanwhile.
   */
  bool awaitMaster();

  class Section {
   public:
    explicit Section(MasterCallGuard& guard) : guard_(guard) { guard_.add(1); }
    ~Section() { guard_.add(-1); }
    Section(const Section&) = delete;
    Section& operator=(const Section&) = delete;

   private:
    MasterCallGuard& guard_;
  };

 private:
  void add(int sections);
  void run();
  void look(bool refused);

  const std::atomic<int>& signal_number_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ending_ = false;
  int sections_ = 0;  // sections may be nested
  int refusals_ = 0;
  int looks_after_signal_ = 0;
  std::thread thread_;  // last, as it uses the other members
};

}  // namespace move_base_abstract
