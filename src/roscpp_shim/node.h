// The program as a participant: its connection to the time master, its reports and its grants.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_NODE_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_NODE_H

#include <ros/callback_queue.h>

#include <atomic>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "lockstep/wire.h"
#include "participant/link.h"
#include "turn.h"

namespace move_base_abstract::shim {

/** @brief ros::Timer's process-wide manager, as timers.cpp opens it. */
struct SimulatedTimers {
  std::function<Nanoseconds()> next;
  std::function<void()> fire;  // puts what is due into the callback queues
};

/** @brief Something that comes from nodes or threads that do not take part. */
struct Input {
  std::function<void()> enter;
  std::string label;                    // why the run is not repeatable then; empty: it is
  ros::CallbackQueue* queue = nullptr;  // of a callback, with its owner
  std::uint64_t owner = 0;
  bool is_urgent = true;  // it asks for a grant; else it enters with the next one there is
};

class Node {
 public:
  Node();

  /** @return whether the run is in lockstep, as the time master's parameter says. */
  static bool isWanted();
  /** @brief Connect, present the node, wait for its first grant. @return whether it takes part. */
  bool join();
  /** @brief Take no more part. From any thread. */
  void leave(const std::string& reason);

  /** @brief Report, and wait for a grant. All threads of the program wait. */
  void exchange();

  void append(const wire::ReportItem& item);
  void label(const std::string& reason);
  /** @brief Threads that wait without end, and for what, count as open work. */
  void open(const std::string& what) { open_.insert(what); }
  void close(const std::string& what) { open_.erase(open_.find(what)); }

  /** @brief Take @p input up with the next grant. From any thread. */
  void fromOutside(Input input);
  /** @brief Forget callbacks of @p owner that have not entered @p queue yet. */
  void removeOutside(const ros::CallbackQueue* queue, std::uint64_t owner);
  void setTimers(SimulatedTimers timers);
  bool hasTimers() const { return has_timers_; }
  void ring() { bell_->ring(); }

  Nanoseconds now() const { return now_; }
  std::uint64_t round() const { return round_; }
  bool isMember(const std::string& node);
  bool isMemberAt(const std::string& uri);
  std::string nameOf(std::uint32_t member);
  std::string uriOf(std::uint32_t member);
  /** @brief Wall time in which a thread may sleep while simulated time stands. */
  bool sleepsSimulated() const { return sleeps_simulated_; }

 private:
  bool connect();
  void sayHello();
  void report();
  void tellWaits(bool is_endless);
  void awaitGrant();
  void readFrames();
  void handle(const wire::Welcome& frame);
  void handle(const wire::Member& frame);
  void handle(const wire::Gone& frame);
  void handle(const wire::Grant& frame);
  void handle(const wire::End& frame);
  void knockIfNeeded();
  bool enterOutside(bool only_if_late);
  void end(const std::string& reason);
  void readRank();

  std::string name_;
  std::int32_t rank_ = 1000;  // robots have 0
  bool rank_declared_ = false;
  bool sleeps_simulated_ = false;

  lockstep::internal::Link link_;
  std::shared_ptr<lockstep::internal::Bell> bell_ = std::make_shared<lockstep::internal::Bell>();
  wire::FrameBuffer frames_;
  std::string received_;

  PlainMutex mutex_;  // for items, state, members and outside
  std::string items_;
  std::set<std::string> labels_;
  std::atomic<bool> is_over_{false};
  bool is_joined_ = false;
  bool is_granted_ = false;
  bool has_knocked_ = false;
  std::uint64_t round_ = 0;
  Nanoseconds now_ = 0;
  std::multiset<std::string> open_;
  std::string told_;  // of it, to the time master
  std::map<std::uint32_t, std::pair<std::string, std::string>> members_;  // name, URI
  std::deque<Input> outside_;
  std::int64_t outside_since_ = 0;  // steady ns; when the oldest came
  SimulatedTimers timers_;
  std::atomic<bool> has_timers_{false};
};

Node& node();
/** @return whether the program takes part, and has not left. */
bool takesPart();
/** @return whether the calling thread is in ros::start(), of a program that is to take part. */
bool isStarting();

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_NODE_H
