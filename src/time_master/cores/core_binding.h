// Binds each process of a run to a core of this computer, and gives it its cores back. No ROS.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_CORES_CORE_BINDING_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_CORES_CORE_BINDING_H

#include <sched.h>
#include <sys/types.h>

#include <map>
#include <string>
#include <vector>

#include "claimed_cores.h"
#include "clock/scaled_clock.h"

namespace move_base_abstract {

/** @brief Which cores the processes have: all the same one, or each one of several. */
enum class CoreLayout { kTogether, kApart };

/**
 * @brief Binds all threads of each added process to one core.
 *
 * kTogether: all have the same core, and one thread of this process has it, too. kApart: each has
 * one of several cores, by the work that it has done, so that each core has as much to do.
 *
 * They are cores that each process may use anyway. A process that changes its own cores is left
 * alone from then on, and so is a process that may not be changed. Not thread-safe.
 */
class CoreBinding {
 public:
  explicit CoreBinding(CoreLayout layout) : layout_(layout) {}
  CoreBinding(const CoreBinding&) = delete;
  CoreBinding& operator=(const CoreBinding&) = delete;
  ~CoreBinding() { release(); }

  /** @brief Make the calling thread the one of this process. */
  void useThisThread();
  void add(pid_t process);
  /** @brief Give @p process, which may have ended, its cores back. */
  void remove(pid_t process);

  /** @return whether there are several cores, and such that all processes may use. */
  bool hasChoice() const;
  /** @brief Bind each process to its core. Call this again for new threads and processes. */
  void bind();
  /** @brief Give all processes their cores back. This run keeps its claims. */
  void release();
  /** @brief Release, and give the claims up. */
  void leaveCores();
  /** @brief Give the child processes, which do not take part, the cores that their parents had. */
  void freeChildren();

  bool isBound() const { return is_bound_; }
  const ClaimedCores& claimed() const { return claimed_; }

 private:
  struct Process {
    std::string began;       // as /proc says, since another process may get its number
    cpu_set_t own;           // of its first thread
    int core = -1;           // the one that it has when it is bound; -1: none yet
    Nanoseconds worked = 0;  // CPU time, when it was added, or when the cores were shared out
    int uses = 0;
    bool is_left_alone = false;
    std::map<pid_t, cpu_set_t> threads;  // the cores that each had
  };
  bool isThere(pid_t id, const Process& process) const;
  void apply(pid_t id, Process& process, bool to_one);
  bool applyTo(pid_t thread, Process& process, bool to_one);
  void leaveAlone(pid_t id, Process& process);
  void freeChildrenOf(pid_t parent, const Process& of, int depth);
  cpu_set_t allowed() const;
  void share();

  Process own_thread_;
  pid_t own_thread_id_ = 0;
  std::map<pid_t, Process> processes_;
  const CoreLayout layout_;
  ClaimedCores claimed_;
  bool is_bound_ = false;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_CORES_CORE_BINDING_H
