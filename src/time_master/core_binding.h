// Binds the processes of a run to one core of this computer, and gives back what each had. No ROS.
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
 * @brief All threads of the processes that are told, and one thread of this process, on one core.
 *
 * Only on a core that each of them may use anyway. A process that changes its own cores is left
 * alone from then on, as is one that may not be changed. Of several runs on this computer each has
 * a core of its own, by a claim that ends with its process. Not for several threads.
 */
class CoreBinding {
 public:
  CoreBinding();
  CoreBinding(const CoreBinding&) = delete;
  CoreBinding& operator=(const CoreBinding&) = delete;
  ~CoreBinding() { release(); }

  /** @brief The calling thread is the one that works beside the processes. */
  void useThisThread();
  void add(pid_t process);
  /** @brief Give back to @p process, which may have ended, what it had. */
  void remove(pid_t process);

  /** @return whether there are several cores to choose from. */
  bool hasChoice() const;
  /**
   * @brief Put all on one core; again, for threads and processes that are new.
   * @param is_wished also on a core that another run has, if there is no other.
   * @return false if there is no core for it: then nothing is bound.
   */
  bool bind(bool is_wished);
  /** @brief Give all their cores back. The core stays this run's. */
  void release();
  /** @brief Choose anew the next time. */
  void leaveCore();
  /** @brief Give the children of the processes, which take no part, the cores of their parents. */
  void freeChildren();

  bool isBound() const { return is_bound_; }
  /** @return the core's number, -1 if none is chosen. */
  int core() const { return core_; }

 private:
  struct Thread {
    cpu_set_t own;  // the cores that it had
    bool is_bound = false;
  };
  struct Process {
    std::string began;  // as /proc says: another process may get its number
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
  std::map<int, Work> work_;  // of each core, at the latest look
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_CORE_BINDING_H
