// A roscpp node's membership in a run: its connection to the time master, its reports and its
// grants. The program itself is behind an interface.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "failure.h"
#include "joining.h"
#include "link.h"
#include "lockstep/wire/wire.h"
#include "report_delay.h"
#include "silence.h"
#include "window.h"

namespace move_base_abstract::lockstep::internal {

/**
 * @brief The functions of a node that its membership calls, in the thread that awaits the grant.
 */
class Program {
 public:
  virtual ~Program() = default;

  /** @brief Lock the data that several threads share. */
  virtual void lock() = 0;
  virtual void unlock() = 0;

  /** @return where the calling thread sleeps while it waits for a grant. */
  virtual Place* place() = 0;
  /**
   * @brief Let one thread at a time look what has come from the time master, until endLook().
   * @return false if another thread waits for the grant by now, or has it.
   */
  virtual bool beginLook() = 0;
  virtual void endLook() = 0;

  virtual void setTime(Nanoseconds now) = 0;
  virtual void handle(const wire::Publisher& item) = 0;
  virtual void handle(const wire::NoPublisher& item) = 0;
  virtual void handle(const wire::Subscriber& item) = 0;
  virtual void handle(const wire::NoSubscriber& item) = 0;
  virtual void handle(const wire::Deliver& item) = 0;
  virtual void handle(const wire::CallIn& item) = 0;
  /** @brief Let input from outside enter. Called after all items of the grant are handled. */
  virtual void onGranted() = 0;

  virtual void onMember(const std::string& name) = 0;
  /** @return whether input from outside of lockstep needs a grant. */
  virtual bool hasInput() = 0;
  /** @brief No grant has come for 100 ms of wall time. @return whether to go on waiting for one. */
  virtual bool waitsOn() = 0;
  /** @brief The time master has ended this node's part. */
  virtual void onEnd() = 0;
  /**
   * @return the id, as gettid() gives it, of the thread that works on the present grant; 0: the
   * thread that has read it.
   */
  virtual int busyThread() = 0;
};

/** @brief The content of a report besides its actions. */
struct Wish {
  Nanoseconds next = kNever;  // simulated
  std::uint32_t open = 0;     // threads that wait without a timeout for something owed to them
  std::string waits = {};     // what they wait for
  std::uint32_t idle = 0;     // threads that wait without a timeout for work
};

/** @brief The outcome of a call of a participant's service. */
struct Reply {
  wire::CallStatus status = wire::CallStatus::kServerGone;
  std::string bytes;

  bool isGood() const { return status == wire::CallStatus::kOk; }
  /** @return the reason why the call has failed. */
  std::string why() const;
};

class Membership {
 public:
  /**
   * kReported: waits for a grant. kOver: has left, or was ended by the time master or ROS.
   */
  enum class State { kNew, kJoining, kTurn, kReported, kOver };

  struct Other {
    std::string name;
    std::string uri;
  };

  explicit Membership(Program& program) : program_(program) {}

  // ---- joining and leaving
  /** @brief Set how the node presents itself. Call this before connect(). */
  void present(Presence presence) { presence_ = std::move(presence); }
  /** @brief See connectToTimeMaster(). */
  bool connect() { return connectToTimeMaster(presence_.name, &link_); }
  /** @brief Present the node and wait for its first grant. @throws Error */
  void join();
  /**
   * @brief Leave the run. If the node has its turn, it sends a last report of what was done. Any
   * thread may call this.
   * @param is_asked_to whether another program has asked for it, at some instant of the wall clock.
   * @return false if there was nothing to leave. Otherwise the thread that reads from the
   * connection must finish() it.
   */
  bool leave(const std::string& reason, bool is_asked_to);
  /** @brief Close the connection when the time master has read all bytes. */
  void finish() { link_.finish(leave_limit_ms_); }
  void ring() { bell_.ring(); }
  /** @return what a thread is doing and where in the program, in short. */
  static std::string describe(int thread);

  // ---- rounds
  /**
   * @brief Send a report if there is a grant, and wait for the next grant, or for the end.
   * @return false if another thread has begun to wait for it, or has it.
   */
  bool exchange(const Wish& wish);
  /** @return whether something has come for the thread that waits for a grant, so that another one
   * may take it in its place. @pre beginLook() */
  bool isOffered() const { return state_ == State::kReported && is_awaited_ && link_.hasPiece(); }
  /** @return the memory that is shared with the time master; null: there is none. */
  SharedChannel* channel() const { return link_.channel(); }
  /**
   * @return whether the latest grant has brought nothing, and was not caused by input from outside.
   */
  bool isPlainGrant() const { return hasTurn() && is_plain_; }
  bool hasTurn() const { return state_ == State::kTurn; }
  bool isActive() const { return state_ == State::kTurn || state_ == State::kReported; }
  bool isOver() const { return state_ == State::kOver; }
  bool isWaiting() const { return state_ == State::kReported || state_ == State::kJoining; }

  const std::string& name() const { return presence_.name; }
  Nanoseconds now() const { return now_; }
  /**
   * @return the instant at which the item that is being handled has come: now(), unless it was
   * kept.
   */
  Nanoseconds came() const { return came_; }
  /**
   * @return the number of the present turn, from 1 on. With a lookahead, several turns may belong
   * to one round.
   */
  std::uint64_t round() const { return turns_; }
  /** @return the time [ns] that everything takes from one participant to another; 0: no time. */
  Nanoseconds lookahead() const { return window_.lookahead(); }
  /**
   * @return how often the time master has said that parameters for which this node has asked may
   * have changed.
   */
  std::uint64_t parameterChanges() const { return parameter_changes_; }

  // ---- the next report
  void append(const wire::ReportItem& item);
  void label(const std::string& reason);

  // ---- calls of services that participants offer; for the thread that has the turn
  /** @return the number of the call. */
  std::uint32_t call(const std::string& service, std::string_view request);
  bool isAnswered(std::uint32_t call) const { return answers_.count(call) > 0; }
  /** @return the answer of a call that isAnswered(). Call this once for each call. */
  Reply takeAnswer(std::uint32_t call) { return std::move(answers_.extract(call).mapped()); }
  /**
   * @brief Ask the time master for news of @p service. When a participant offers it, isFound() is
   * true.
   */
  void watch(const std::string& service);
  bool isFound(const std::string& service) const { return found_.count(service) > 0; }

  // ---- the members, with this node. Any thread may call these.
  bool isMember(const std::string& name);
  bool isMemberAt(const std::string& uri);
  /** @return the names of the members. */
  std::set<std::string> present();
  /** @return the names of former members. */
  std::set<std::string> gone();
  /** @return the member of a number; without a name if it has gone. */
  Other memberOf(std::uint32_t number);
  /** @return whether roscpp alone carries @p topic, as the time master says. */
  bool isExcluded(const std::string& topic) const { return excluded_.count(topic) > 0; }

 private:
  bool walk(const Wish& wish);
  void beginTurn(const wire::Grant& grant, Nanoseconds now, std::uint32_t microstep);
  void report(const Wish& wish);
  bool awaitGrant();
  void knockIfNeeded();
  void readFrames();
  void handle(const wire::Welcome& frame);
  void handle(const wire::Member& frame);
  void handle(const wire::Gone& frame);
  void handle(wire::Grant& grant);
  void handle(const wire::End& frame);
  void take(const wire::Answer& item);
  void take(const wire::Found& item);
  void take(const wire::Happened&) {}        // it reports no turns beforehand
  void take(const wire::DeliveryChosen&) {}  // the time master drops what is not heard
  void take(const wire::Window&) {}          // it was taken out of the grant before
  void take(const wire::Arrives&) {}
  void take(const wire::Came& item) { came_ = item.time_ns; }
  void take(const wire::Changed&) { ++parameter_changes_; }
  template <class Item>
  void take(const Item& item) {
    program_.handle(item);
  }
  void end(const std::string& reason, bool as_wished = false);
  std::uint64_t grantedRound();
  void tellBusy(std::uint64_t round);

  Program& program_;
  Presence presence_;
  ReportDelay delay_;
  Link link_;
  Bell bell_;
  wire::FrameBuffer frames_;

  // Under the program's lock: changes of the state, and the fields below.
  std::atomic<State> state_{State::kNew};
  std::string items_;  // of the next report
  std::set<std::string> labels_;
  std::map<std::uint32_t, Other> members_;
  std::multiset<std::string> names_;  // of members
  std::set<std::string> gone_;        // names of former members
  bool has_knocked_ = false;

  // From WELCOME, before the first grant.
  std::set<std::string> excluded_;
  int leave_limit_ms_ = 0;  // wall

  std::atomic<int> reader_{0};  // thread that has read the latest grant, as gettid() gives it
  std::atomic<bool> is_awaited_{true};  // a thread waits for the grant
  std::uint64_t round_ = 0;
  std::uint64_t turns_ = 0;
  Window window_;
  Nanoseconds told_at_ = 0;     // the instant of the latest appended item
  bool must_report_ = false;    // before its next turn, also within a window
  bool is_background_ = false;  // time does not go on for its wake-up alone
  bool is_plain_ = false;
  Nanoseconds now_ = 0;
  Nanoseconds came_ = 0;
  std::uint32_t microstep_ = 0;
  std::string told_;  // what it waits for, as it has told the time master
  std::uint64_t parameter_changes_ = 0;
  std::uint32_t calls_made_ = 0;
  std::map<std::uint32_t, Reply> answers_;
  std::set<std::string> found_;
  SilenceWatch silence_;
};

}  // namespace move_base_abstract::lockstep::internal
