// Watches whether the ROS master lives, and which nodes use simulated time, in a thread of its own.
#pragma once

#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>

namespace move_base_abstract {

/**
 * @brief Asks the ROS master every one or two wall seconds, so that no other thread has to wait for
 * it.
 *
 * The master counts as gone if its port refuses connections three times in a row, or if another
 * process answers there, which does not know the nodes. A slow master does not count as gone.
 */
class RosMasterWatch {
 public:
  /** Begins to watch. Call this after ros::init. */
  RosMasterWatch();
  ~RosMasterWatch();

  RosMasterWatch(const RosMasterWatch&) = delete;
  RosMasterWatch& operator=(const RosMasterWatch&) = delete;

  /** @return why the ROS master counts as gone; '' while it does not. */
  std::string gone() const;

  /** @return the other living nodes that subscribe to /clock, as of one or two wall seconds ago. */
  std::set<std::string> clockSubscribers() const;

  /** @brief Set the nodes that are known to live, so that they need not be asked. */
  void setKnown(std::set<std::string> names);

  /** @return how often the master has answered the request for clockSubscribers(). */
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
  std::map<std::string, bool> lives_;  // as of the latest look at each node
  int pid_ = 0;
  std::thread thread_;  // last, as it uses the other members
};

/**
 * @brief Set a parameter. This waits 10 wall seconds at most for the ROS master; roscpp's own call
 * may wait for ever.
 * @throws std::runtime_error if the master has not answered by then.
 */
void setParameter(const std::string& key, const std::string& value);

/** @brief Delete a parameter, also while ROS shuts down. This waits a wall second at most. */
void deleteParameter(const std::string& key);

}  // namespace move_base_abstract
