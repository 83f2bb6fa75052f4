// Who runs: of the program's own threads one at a time, which hands over where it waits.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_TURN_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_TURN_H

#include <pthread.h>
#include <semaphore.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lockstep/wire/wire.h"

namespace move_base_abstract::shim {

/** @brief A lock that is libc's own: not one of those that hand the turn over. */
class PlainMutex {
 public:
  void lock();
  void unlock();

 private:
  pthread_mutex_t mutex_ = PTHREAD_MUTEX_INITIALIZER;
};

/** @brief What a thread waits for. Without anything it only lets the others go first. */
struct Wait {
  Nanoseconds until = kNever;     // simulated
  std::function<bool()> is_over;  // looked at by whoever has the turn
  const void* object = nullptr;   // a condition, which somebody may signal
  const void* pool = nullptr;     // threads that wait for the same and do the same: any will do
  bool next_round = false;        // until the next grant, which is asked for at this instant
  bool at_rest = false;   // until nobody who takes part has anything left to do at this instant
  bool activity = false;  // until another thread has run,
  Nanoseconds activity_from = 0;  // and this instant has come; at once where a thread is waited for
  Nanoseconds activity_by = kNever;     // if one has run: at the latest then
  bool for_thread = false;              // it is another thread that must do something
  std::function<void()> unlock;         // called when a signal can no longer be missed
  const char* what = nullptr;           // of a wait without end for another thread: shown
  bool is_on_descriptors = false;       // others than its threads may end it, which is told
  bool is_owed = false;                 // that thread must do it; else it is work that may come
  const struct Task* end_of = nullptr;  // it is the end of that one
};

enum class Woken { kReady, kTime, kEnd };

/** @brief A thread of the program. */
struct Task {
  sem_t go;
  pthread_t thread{};
  int tid = 0;
  Wait wait;
  bool is_waiting = false;
  bool is_signalled = false;
  bool is_loose = false;     // it runs beside the others: it blocks where nobody can see it
  bool is_blocking = false;  // it blocks in a known way, with time standing still
  bool has_spun = false;     // it has computed for so long that the others went on
  std::atomic<bool> is_done{false};
  std::uint64_t seen_activity = 0;
  bool in_spinner = false;        // its waits for callbacks are without end
  unsigned in_callbacks = 0;      // the callback of a callback, say
  bool has_acted = false;         // since its last wait for callbacks
  unsigned idle_polls = 0;        // waits for callbacks in a row that were in vain
  unsigned empty_polls = 0;       // looks without waiting in a row that were in vain
  unsigned clock_reads = 0;       // at one instant
  Nanoseconds slept_at = -1;      // instant at which it has slept by the wall clock,
  Nanoseconds slept = 0;          // for how long altogether,
  unsigned naps = 0;              // and how often
  unsigned yields = 0;            // in a row
  bool sleeps_simulated = false;  // from when on that has been too long
  std::function<void*()> main;    // of a thread that has not begun
  std::vector<std::function<void()>> at_end;
};

/** @brief What the program's threads wait for without end. */
struct OpenWaits {
  std::vector<std::string> owed;
  std::vector<std::string> work;
};

/** @brief Marks that a thread runs roscpp's or this library's own code: nothing is intercepted. */
class Inside {
 public:
  Inside();
  ~Inside();
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;
};

/**
 * @brief Marks that a thread of the program works on what roscpp's own threads share: what is
 * allocated meanwhile depends on how far those are, and comes from libc's heap.
 */
class Beside {
 public:
  Beside();
  ~Beside();
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;
};

/** @brief Marks that what the thread starts is roscpp's own, while it sees the run's clocks. */
class StartsInternal {
 public:
  StartsInternal();
  ~StartsInternal();
  StartsInternal(const StartsInternal&) = delete;
  StartsInternal& operator=(const StartsInternal&) = delete;
};

/** @brief Marks that a thread blocks in a known way, with time standing still. */
class Blocking {
 public:
  Blocking();
  ~Blocking();
  Blocking(const Blocking&) = delete;
  Blocking& operator=(const Blocking&) = delete;

 private:
  Inside inside_;
};

class Turn {
 public:
  /** @brief The calling thread is the program's first, and has the turn. */
  void begin();
  /** @brief No more turns: every thread goes on as if this library were not here. */
  void end();
  bool isActive() const { return is_active_.load(std::memory_order_relaxed); }

  /**
   * @return whether the calling thread is one of the program's, and has the turn; waits for it
   * where it ran beside the others. A thread that is not known yet becomes one of them.
   */
  bool enter();
  /** @return the same, but leaves threads alone that are not known. */
  bool holds();
  /** @return the calling thread, if it is one of the program's. */
  static Task* self();
  static bool isInside();
  /** @brief Call @p function when the calling thread, one of the program's, ends: its last thing.
   */
  static void atEnd(std::function<void()> function);
  /** @brief The calling thread is roscpp's own. */
  static void becomeInternal();
  static bool isInternal();
  /** @return whether threads that the calling one starts are roscpp's own. */
  static bool startsInternal();

  /** @return whether what the calling thread allocates is a part of the order of turns. */
  static bool allocatesInOrder();
  /** @return whether what it gives back is. */
  static bool freesInOrder();

  /** @brief Give the turn away until what @p wait says. For a thread that has entered. */
  Woken wait(Wait wait);
  /** @brief Wake who waits for @p object: one, or all. From any thread. */
  void signal(const void* object, bool all);

  /** @return a thread about to be created, whose function is @p main. */
  std::shared_ptr<Task> create(std::function<void*()> main);
  /** @brief It could not be created. */
  void discard(const std::shared_ptr<Task>& task);
  /** @brief What the new thread runs. */
  void* run(Task* task);
  /** @return the task of @p thread, if it is one of the program's that has not ended. */
  std::shared_ptr<Task> find(pthread_t thread);
  /** @return whether the thread with @p tid waits, so that it cannot unlock anything. */
  bool isParked(int tid);

  /** @return the thread that has the turn, as gettid() says; 0: none. From any thread. */
  int holder();

  /** @return what threads wait for others to do, as long as it takes. */
  OpenWaits openWaits();
  /** @return whether a thread waits until nobody has anything left to do. */
  bool isResting();
  /** @return when the first of the threads wants to go on. */
  Nanoseconds nextWake();
  /** @return the first instant at which a thread goes on with any grant, or kNever. */
  Nanoseconds firstLook();
  /** @return whether somebody who ran beside the others, or was signalled by others, can go on. */
  bool hasGuest();

 private:
  /** @brief Tells of the end of a thread: the last thing that it does. */
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
  void park(Task* task);
  void finish(Task* task);
  void forget(const Task* task);
  void watch();
  Task* findWoken();
  void letOthersOn(const std::string& why);

  std::atomic<bool> is_active_{false};
  PlainMutex mutex_;  // for what follows; only who has the turn looks at Task::wait
  Ends ends_;
  std::vector<std::shared_ptr<Task>> tasks_;
  std::vector<Task*> waiting_;
  Task* holder_ = nullptr;
  std::uint64_t switches_ = 0;
  std::uint64_t activity_ = 0;
  int waits_for_threads_ = 0;  // of those in waiting_
};

Turn& turn();

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_TURN_H
