// Binds the processes of a run to one core of this computer, and gives them their cores back. No
// ROS.
#pragma once

#include <sched.h>
#include <sys/types.h>

#include <map>
#include <string>
#include <vector>

#include "claimed_core.h"

namespace move_base_abstract {

/**
 * @brief Binds all threads of each added process, and one thread of this process, to the same core.
 *
 * It is a core that each process may use anyway. A process that changes its own cores is left
 * alone from then on, and so is a process that may not be changed. Not thread-safe.
 */
class CoreBinding {
 public:
  CoreBinding() = default;
  CoreBinding(const CoreBinding&) = delete;
  CoreBinding& operator=(const CoreBinding&) = delete;
  ~CoreBinding() { release(); }

  /** @brief Make the calling thread the one of this process. */
  void useThisThread();
  void add(pid_t process);
  /** @brief Give @p process, which may have ended, its cores back. */
  void remove(pid_t process);

  /**
   * @brief Bind the processes, if there is a core that all may use, and one of them has others.
   * Call this again for new threads and processes.
   * @param anew whether to choose another core if there is a better one.
   */
  void bind(bool anew);
  /** @brief Give all processes their cores back. This run keeps its claim. */
  void release();
  /** @brief Release, and give the claim up. */
  void leaveCore();
  /** @brief Give the child processes, which do not take part, the cores that their parents had. */
  void freeChildren();

  bool isBound() const { return is_bound_; }
  const ClaimedCore& claimed() const { return claimed_; }

 private:
  struct Process {
    std::string began;  // as /proc says, since another process may get its number
    cpu_set_t own;      // of its first thread
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
  bool isOnly(const cpu_set_t& cores) const;

  Process own_thread_;
  pid_t own_thread_id_ = 0;
  std::map<pid_t, Process> processes_;
  ClaimedCore claimed_;
  bool is_bound_ = false;
};

}  // namespace move_base_abstract
