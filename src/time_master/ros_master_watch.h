// Watches the ROS master: does it live, and which nodes use simulated time? In a thread of its own.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_ROS_MASTER_WATCH_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_ROS_MASTER_WATCH_H

#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>

namespace move_base_abstract {

/**
 * @brief Asks the ROS master every wall second or two, so that nobody else has to wait for it.
 *
 * The master is gone when its port refuses connections three times in a row, or when another
 * process answers there: it has forgotten all nodes. One that is only slow is not gone.
 */
class RosMasterWatch {
 public:
  /** Begins to watch. Call it after ros::init. */
  RosMasterWatch();
  ~RosMasterWatch();

  RosMasterWatch(const RosMasterWatch&) = delete;
  RosMasterWatch& operator=(const RosMasterWatch&) = delete;

  /** @return why the ROS master counts as gone; '' while it does not. */
  std::string gone() const;

  /** @return the other living nodes that subscribe to /clock, as of a second or two ago. */
  std::set<std::string> clockSubscribers() const;

  /** @brief These are known to live: nobody needs to ask them. */
  void setKnown(std::set<std::string> names);

  /** @return how often clockSubscribers() was asked of the master and answered. */
  int answers() const { return answers_; }

 private:
  void run();
  void look();
  void readSubscribers();
  bool lives(const std::string& name);
  void setGone(const std::string& why);

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool ending_ = false;
  std::string gone_;
  std::set<std::string> subscribers_;
  std::set<std::string> known_;
  std::atomic<int> answers_{0};
  int refusals_ = 0;
  int looks_ = 0;
  std::map<std::string, bool> lives_;  // as of the latest look at each
  int pid_ = 0;
  std::thread thread_;  // last: it uses the others
};

/**
 * @brief Set a parameter. Waits 10 s at most for the master: roscpp's own call may wait for ever.
 * @throws std::runtime_error if it has not answered by then.
 */
void setParameter(const std::string& key, const std::string& value);

/** @brief Delete a parameter, also while ROS shuts down. Waits a second at most for the master. */
void deleteParameter(const std::string& key);

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_ROS_MASTER_WATCH_H
