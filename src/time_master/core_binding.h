// Binds the processes of a run to one core of this computer, and gives each its cores back. No ROS.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_CORE_BINDING_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_CORE_BINDING_H

#include <sched.h>
#include <sys/types.h>

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "descriptor.h"

namespace move_base_abstract {

/**
 * @brief Binds all threads of the added processes, and one thread of this process, to one core.
 *
 * It is a core that each of them may use anyway. A process that changes its own cores is left alone
 * from then on, and so is a process that may not be changed. Each run on this computer has a core
 * of its own, by a claim that ends with its process. Not thread-safe.
 */
class CoreBinding {
 public:
  CoreBinding();
  CoreBinding(const CoreBinding&) = delete;
  CoreBinding& operator=(const CoreBinding&) = delete;
  ~CoreBinding() { release(); }

  /** @brief Make the calling thread the one that is bound together with the processes. */
  void useThisThread();
  void add(pid_t process);
  /** @brief Give @p process, which may have ended, its cores back. */
  void remove(pid_t process);

  /** @return whether there are several cores to choose from. */
  bool hasChoice() const;
  /**
   * @brief Bind all to one core. Call this again for new threads and processes.
   * @param is_wished whether a core of another run may be taken, if there is no other.
   * @return false if there is no core. Then nothing is bound.
   */
  bool bind(bool is_wished);
  /** @brief Give all processes their cores back. This run keeps the claim on its core. */
  void release();
  /** @brief Release, and choose another core the next time. */
  void leaveCore();
  /** @brief Give the child processes, which do not take part, the cores that their parents had. */
  void freeChildren();

  bool isBound() const { return is_bound_; }
  /** @return the number of the core; -1 if none is chosen. */
  int core() const { return core_; }

 private:
  struct Thread {
    cpu_set_t own;  // the cores that it had
    bool is_bound = false;
  };
  struct Process {
    std::string began;  // as /proc says, since another process may get its number
    cpu_set_t own;      // of its first thread
    int uses = 0;
    bool is_left_alone = false;
    std::map<pid_t, Thread> threads;
  };
  struct Work {
    double idle = 0.0;  // ticks
    double all = 0.0;
  };

  bool isThere(pid_t id, const Process& process) const;
  void apply(pid_t id, Process& process, bool to_one);
  bool applyTo(pid_t thread, Process& process, bool to_one);
  void leaveAlone(pid_t id, Process& process);
  void freeChildrenOf(pid_t parent, const cpu_set_t& own, int depth);
  cpu_set_t allowed() const;
  bool isOne(const cpu_set_t& cores) const;
  bool choose(bool is_wished);
  std::map<int, Work> takeWork();

  Process own_thread_;
  pid_t own_thread_id_ = 0;
  std::map<pid_t, Process> processes_;
  int core_ = -1;
  int avoided_ = -1;
  cpu_set_t one_;
  bool is_bound_ = false;
  Descriptor claim_;
  std::map<int, Work> work_;  // of each core, at the latest takeWork()
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_CORE_BINDING_H
