// The program as a participant: the state of all its threads, and input from outside of lockstep.
#pragma once

#include <ros/callback_queue.h>

#include <array>
#include <atomic>
#include <deque>
#include <functional>
#include <set>
#include <string>

#include "roscpp_shim/membership/membership.h"
#include "turn.h"

namespace move_base_abstract::shim {

/** @brief The kinds of timers. Timers that are due at one instant fire in this order. */
enum TimerKind { kRosTimers, kSteadyTimers, kWallTimers, kKernelTimers, kTimerKinds };

/** @brief Access to all timers of one kind in this process; the code that knows them provides it.
 */
struct SimulatedTimers {
  std::function<Nanoseconds()> next;  // simulated
  std::function<void()> fire;         // puts what is due into the callback queues, for example
  std::function<void()> release;      // from now on they go by the machine's clock; may be empty
};

/** @brief Input from nodes or threads that do not take part. */
struct Input {
  std::function<void()> enter;
  std::string label;                    // why it makes the run not repeatable; empty: it does not
  ros::CallbackQueue* queue = nullptr;  // if it is a callback: its queue and its owner
  std::uint64_t owner = 0;
  bool is_urgent = true;  // it asks for a grant; false: it enters with the next grant
};

class Node : public lockstep::internal::Program {
 public:
  using Membership = lockstep::internal::Membership;

  Node();

  /** @return whether the run is in lockstep, as the time master's parameter says. */
  static bool isWanted();
  /** @brief Connect, introduce the node, wait for its first grant. @return whether it takes part.
   */
  bool join();
  /** @brief Leave the run. From any thread. */
  void leave(const std::string& reason);

  /**
   * @brief Report, and wait for a grant. @pre All threads of the program wait.
   * @return false if another thread waits for it by now, or has it.
   */
  bool exchange();
  /** @brief If a grant has come, take it, although another thread waits for it. @return whether the
   * calling thread has it. */
  bool takeGrant();

  Membership& membership() { return membership_; }
  void append(const wire::ReportItem& item) { membership_.append(item); }
  void label(const std::string& reason) { membership_.label(reason); }
  /** @brief Begin and end an open wait: a thread waits without a time-out for @p what. */
  void open(const std::string& what) { open_.insert(what); }
  void close(const std::string& what) { open_.erase(open_.find(what)); }

  /** @brief Let @p input enter with the next grant. From any thread. */
  void fromOutside(Input input);
  /** @brief Forget callbacks of @p owner that have not entered @p queue yet. */
  void removeOutside(const ros::CallbackQueue* queue, std::uint64_t owner);
  void setTimers(TimerKind kind, SimulatedTimers timers);
  bool hasTimers(TimerKind kind) const { return has_timers_[kind]; }
  void ring() { membership_.ring(); }

  Nanoseconds now() const { return membership_.now(); }
  /** @brief Set the time that roscpp shows. @pre The thread has the turn. */
  void setTime(Nanoseconds now) override;
  std::uint64_t round() const { return membership_.round(); }
  /** @return the latest round that was granted because no participant had anything left to do. */
  std::uint64_t restRound() const { return rest_round_; }
  /** @return whether sleeps by the wall clock take simulated time (--sleep simulated). */
  bool sleepsSimulated() const { return sleeps_simulated_; }

 private:
  // Program
  void lock() override { mutex_.lock(); }
  void unlock() override { mutex_.unlock(); }
  Place* place() override;
  bool beginLook() override;
  void endLook() override { look_.unlock(); }
  void handle(const wire::Publisher& item) override;
  void handle(const wire::NoPublisher& item) override;
  void handle(const wire::Subscriber& item) override;
  void handle(const wire::NoSubscriber& item) override;
  void handle(const wire::Deliver& item) override;
  void handle(const wire::CallIn& item) override;
  void onGranted() override;
  void onMember(const std::string& name) override;
  bool hasInput() override;
  bool waitsOn() override;
  void onEnd() override;
  int busyThread() override { return turn().holder(); }

  lockstep::internal::Wish wish();
  std::string waits(const OpenWaits& threads) const;
  void keepUnread();
  void endTurns();
  bool enterOutside(bool only_if_late);

  bool sleeps_simulated_ = false;
  PlainMutex mutex_;  // for the membership and for outside_
  PlainMutex look_;   // see beginLook()
  Membership membership_{*this};
  std::multiset<std::string> open_;
  bool awaits_rest_ = false;  // and nothing else
  std::uint64_t rest_round_ = 0;
  std::deque<Input> outside_;
  std::int64_t outside_since_ = 0;  // steady ns: when the oldest input came; 0: none
  std::array<SimulatedTimers, kTimerKinds> timers_;
  std::array<std::atomic<bool>, kTimerKinds> has_timers_{};
};

Node& node();
/** @return whether the program takes part, and has not left. */
bool takesPart();
/** @return whether the calling thread is in ros::start(), of a program that is to take part. */
bool isStarting();

/** @return whether messages on @p topic go through the time master. */
bool isManaged(const std::string& topic);

}  // namespace move_base_abstract::shim
