// Ends the process where a call to a ROS master that has gone would hold it up for ever.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_MASTER_CALL_GUARD_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_MASTER_CALL_GUARD_H

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace move_base_abstract {

/**
 * @brief roscpp's calls to the ROS master have no end where it dies in the middle of one, and are
 * repeated without end where it has died before.
 *
 * While a Section lives and the master refuses connections three times in a row (a wall second
 * apart), or a signal has asked for the end and 3 s have passed, the process says so and ends with
 * code 1. A section must have nothing in hand that would be lost.
 */
class MasterCallGuard {
 public:
  /** @param signal_number not 0: the process was asked to end. Call it after ros::init. */
  explicit MasterCallGuard(const std::atomic<int>& signal_number);
  ~MasterCallGuard();
  MasterCallGuard(const MasterCallGuard&) = delete;
  MasterCallGuard& operator=(const MasterCallGuard&) = delete;

  /** @brief Wait for the ROS master. @return false if a signal has asked for the end meanwhile. */
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
  int sections_ = 0;  // one may contain others
  int refusals_ = 0;
  int looks_after_signal_ = 0;
  std::thread thread_;  // last: it uses the others
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_MASTER_CALL_GUARD_H
