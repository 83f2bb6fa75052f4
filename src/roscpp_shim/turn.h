// Which thread runs: one of the program's own threads at a time has the turn, and hands it over
// when it waits.
#pragma once

#include <pthread.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/shared_channel.h"
#include "lockstep/wire/wire.h"

namespace move_base_abstract::shim {

/** @brief A lock of libc's own, which does not hand the turn over. */
class PlainMutex {
 public:
  void lock();
  void unlock();

 private:
  pthread_mutex_t mutex_ = PTHREAD_MUTEX_INITIALIZER;
};

/** What a thread does again and again: how often in a row, and when last [ns, simulated]. */
struct Repeated {
  unsigned count = 0;
  Nanoseconds at = -1;
};

/** @brief What a thread waits for. An empty Wait only lets the other threads go first. */
struct Wait {
  Nanoseconds until = kNever;        // simulated
  std::function<bool()> is_over;     // the thread with the turn calls it
  const void* object = nullptr;      // a condition that another thread may signal
  const void* queue = nullptr;       // a callback queue; its callbacks end the wait
  bool is_in_pool = false;           // others of that queue do the same: any of them may go on
  bool next_round = false;           // until the next grant, which it requests at this instant
  bool at_rest = false;              // until no participant has anything left to do at this instant
  bool activity = false;             // until another thread has run,
  Nanoseconds activity_from = 0;     // and this instant has come; at once if any waits for another
  Nanoseconds activity_by = kNever;  // if one has run: then at the latest
  bool for_thread = false;           // another thread must do something
  std::function<void()> unlock;      // called when a signal can no longer be missed
  const char* what = nullptr;        // shown for a wait without end for another thread
  bool is_on_descriptors = false;    // may be ended from outside, which labels the run
  bool is_owed = false;              // that thread must do it; false: work that may come
  const struct Task* end_of = nullptr;  // it waits for the end of this thread
};

enum class Woken { kReady, kTime, kEnd };

/** @brief A thread of the program. */
struct Task {
  Sleeper own;              // without shared memory
  Sleeper* sleeper = &own;  // where it sleeps
  Place place;              // of `sleeper`, in the shared memory
  pthread_t thread{};
  int tid = 0;
  Wait wait;
  bool is_waiting = false;
  bool is_signalled = false;
  bool is_loose = false;     // it runs beside the others, as it blocks unseen or computes for long
  bool is_blocking = false;  // it blocks in a known way, with time standing still
  bool has_spun = false;     // it has computed for so long that the others went on
  std::atomic<bool> is_done{false};
  std::uint64_t seen_activity = 0;
  bool in_spinner = false;        // its waits for callbacks are without end
  unsigned in_callbacks = 0;      // depth: a callback may call callbacks
  bool has_acted = false;         // since its last wait for callbacks
  unsigned idle_polls = 0;        // waits for callbacks in vain, in a row
  unsigned empty_polls = 0;       // looks without waiting in vain, in a row
  unsigned clock_reads = 0;       // at one instant
  Nanoseconds slept_at = -1;      // instant at which it has slept by the wall clock,
  Nanoseconds slept = 0;          // for how long altogether,
  unsigned naps = 0;              // and how often
  unsigned yields = 0;            // in a row
  unsigned tries = 0;             // to take a lock, in vain and in a row
  Repeated calls;                 // of services
  Repeated questions;             // to the ROS master
  Repeated messages;              // that it has waited for
  bool sleeps_simulated = false;  // these sleeps were too long, so its sleeps are simulated now
  std::function<void*()> main;    // its function, until it has begun
  std::vector<std::function<void()>> at_end;
};

/** @brief What the program's threads wait for without end. */
struct OpenWaits {
  std::vector<std::string> owed;
  std::vector<std::string> work;
};

/** @brief What each thread knows of itself. It is found without an allocation, because programs
 * take locks and allocate memory before anything else has run. */
struct TurnLocal {
  Task* task;         // its Task, if it is a thread of the program that has begun
  int inside;         // see Inside
  int beside;         // see Beside
  int starts;         // see StartsInternal
  bool is_internal;   // the thread is roscpp's or this library's own
  signed char first;  // 1: it is the process's first thread; -1: it is not; 0: not looked up
};

extern __thread TurnLocal t_local __attribute__((tls_model("initial-exec")));

/** @brief Counts the marks of its kind that the calling thread has. */
template <int TurnLocal::*kCount>
class Mark {
 public:
  Mark() { ++(t_local.*kCount); }
  ~Mark() { --(t_local.*kCount); }
  Mark(const Mark&) = delete;
  Mark& operator=(const Mark&) = delete;
};

/** @brief Marks that a thread runs code of roscpp or of this library: nothing is intercepted. */
using Inside = Mark<&TurnLocal::inside>;

/**
 * @brief Marks that a thread of the program works on data that roscpp's own threads share.
 *
 * What it allocates meanwhile depends on how far those threads are, and so comes from libc's heap.
 */
using Beside = Mark<&TurnLocal::beside>;

/** @brief Marks that threads which the thread starts are roscpp's own, while it sees the clocks of
 * the run. */
using StartsInternal = Mark<&TurnLocal::starts>;

/** @brief Marks that a thread blocks in a known way, while time stands still. */
class Blocking {
 public:
  Blocking();
  ~Blocking();

 private:
  Inside inside_;
};

class Turn {
 public:
  /** @brief Begin the turns: the calling thread is the program's first, and has the turn. */
  void begin();
  /** @brief End the turns: every thread goes on as if this library were not here. */
  void end();
  bool isActive() const { return is_active_.load(std::memory_order_relaxed); }

  /**
   * @return whether the calling thread is one of the program's, and has the turn. If it ran beside
   * the others, it waits for its turn. A thread that is not known yet becomes one of the program's.
   */
  bool enter();
  /** @return the same, but false for threads that are not known. */
  bool holds();
  /** @return the calling thread, if it is one of the program's. */
  static Task* self();
  static bool isInside();
  /** @brief Call @p function at the very end of the calling thread, which is one of the program's.
   */
  static void atEnd(std::function<void()> function);
  /** @brief Mark the calling thread as roscpp's own. */
  static void becomeInternal();
  static bool isInternal();
  /** @return whether threads that the calling thread starts are roscpp's own. */
  static bool startsInternal();

  /** @return whether allocations of the calling thread follow the order of the turns. */
  static bool allocatesInOrder();
  /** @return whether what the calling thread frees follows it. */
  static bool freesInOrder();

  /** @brief Give the turn away until @p wait is over. @pre The thread has entered. */
  Woken wait(Wait wait);
  /** @brief Wake one thread that waits for @p object, or all. From any thread. */
  void signal(const void* object, bool all);

  /** @return the Task of a thread that is about to be created, with the function @p main. */
  std::shared_ptr<Task> create(std::function<void*()> main);
  /** @brief Forget a Task whose thread could not be created. */
  void discard(const std::shared_ptr<Task>& task);
  /** @brief The function of a new thread: waits for its turn, then runs the Task's function. */
  void* run(Task* task);
  /** @return the task of @p thread, if it is one of the program's that has not ended. */
  std::shared_ptr<Task> find(pthread_t thread);
  /** @return whether the thread @p tid waits for its turn, so that it cannot unlock anything. */
  bool isParked(int tid);

  /** @return the thread that has the turn, by its gettid() number; 0: none. From any thread. */
  int holder();
  /** @return whether the calling thread acts for all while all wait. */
  bool acts();
  /** @brief Let the calling thread act for all. @pre All wait. */
  void act();
  /** @brief Say which thread goes on, by the queues of messages or at @p next. */
  void direct(Nanoseconds next, Directions* directions);
  /** @return the number that stands for a callback queue there; two may share one. */
  static std::uint8_t numberOf(const void* queue);

  /** @return what threads wait for without a time-out. */
  OpenWaits openWaits();
  /** @return whether a thread waits until no participant has anything left to do. */
  bool isResting();
  /** @return the first instant at which a thread wants to go on; kNever: none does. */
  Nanoseconds nextWake();
  /** @return the first instant at which a thread goes on with any grant, or kNever. */
  Nanoseconds firstLook();
  /** @return what a thread has waited for that others have signalled; "": a thread that ran beside
   * the others can go on; null: there is none. */
  const char* guest();

 private:
  /** @brief Notices the end of a thread, as the last thing that the thread does. */
  class Ends {
   public:
    void prepare();
    void await();

   private:
    static void onEnd(void* pass);
    pthread_key_t key_ = 0;
  };

  Task* adopt();
  void regain(Task* task);
  bool enlist(Task* task, Wait& wait);
  Task* firstReady();
  bool isReady(const Task& task, bool* by_activity) const;
  void handOver(Task* next);
  void await(Task* me, bool acts);
  void letAct(Task* task);
  bool isLatestInPool(const void* queue) const;
  void takePlace(Task* task);
  void tellEndOf(const Task* task);
  void finish(Task* task);
  void forget(const Task* task);
  void watch();
  Task* findWoken();
  void letOthersOn(const std::string& why);
  void standIn();

  std::atomic<bool> is_active_{false};
  PlainMutex mutex_;  // for what follows; only the thread with the turn looks at Task::wait
  Ends ends_;
  std::vector<std::shared_ptr<Task>> tasks_;
  std::vector<Task*> waiting_;
  std::vector<Task*> looked_at_;                           // a copy; of the thread that acts
  std::array<bool, SharedChannel::kPlaces> places_{true};  // which are taken; 0 is not a thread's
  Task* holder_ = nullptr;                                 // or the thread that acts while all wait
  Task* latest_ = nullptr;                                 // the thread that has waited last
  std::uint64_t switches_ = 0;
  std::uint64_t activity_ = 0;
  int waits_for_threads_ = 0;  // of those in waiting_
};

Turn& turn();

}  // namespace move_base_abstract::shim
