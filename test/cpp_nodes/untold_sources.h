// Calls that lockstep does not follow, each once.
#pragma once

#include <fcntl.h>
#include <mqueue.h>
#include <poll.h>
#include <semaphore.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/msg.h>
#include <sys/resource.h>
#include <sys/select.h>
#include <sys/sem.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/sysinfo.h>
#include <sys/time.h>
#include <sys/times.h>
#include <sys/wait.h>
#include <threads.h>
#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <string>

namespace untold_sources {

/** @return an epoll set with a socket in it. */
inline int connectedSet() {
  const int set = epoll_create1(0);
  epoll_event event{};
  epoll_ctl(set, EPOLL_CTL_ADD, socket(AF_INET, SOCK_DGRAM, 0), &event);
  return set;
}

inline char shell[] = "true";
inline char* const arguments[] = {shell, nullptr};
inline const timespec none{0, 0};
inline mtx_t mutex;
inline cnd_t condition;

/** Map a file as shared memory. */
template <typename Function>
int map(Function function) {
  const int file = memfd_create("test", 0);
  return ftruncate(file, 4096) != 0 ||
         function(nullptr, 4096, PROT_READ, MAP_SHARED, file, 0) == MAP_FAILED;
}

inline const std::map<std::string, std::function<int()>> all = {
    // Calls about the process itself, its use of the processor, and semaphores that others share.
    {"getpid", [] { return getpid() > 0; }},
    {"getppid", [] { return getppid() > 0; }},
    {"gettid", [] { return gettid() > 0; }},
    {"syscall", [] { return syscall(SYS_gettid) < 0; }},
    {"times",
     [] {
       tms spent;
       return times(&spent) > 0;
     }},
    {"getrusage",
     [] {
       rusage usage;
       return getrusage(RUSAGE_SELF, &usage);
     }},
    {"sem_open",
     [] {
       sem_t* const shared = sem_open("/move_base_abstract_test", O_CREAT, 0600, 1);
       sem_unlink("/move_base_abstract_test");
       return sem_wait(shared);
     }},
    {"sem_init",
     [] {
       sem_t shared;
       const int made = sem_init(&shared, 1, 1);
       return made + sem_wait(&shared);
     }},
    // Waits for descriptors.
    {"poll",
     [] {
       pollfd in{STDIN_FILENO, POLLIN, 0};
       return poll(&in, 1, 0) >= 0;
     }},
    {"select",
     [] {
       fd_set set;
       FD_ZERO(&set);
       FD_SET(STDIN_FILENO, &set);
       timeval at_once{0, 0};
       return select(1, &set, nullptr, nullptr, &at_once) >= 0;
     }},
    {"epoll_wait",
     [] {
       const int set = connectedSet();
       epoll_event event;
       return epoll_wait(set, &event, 1, 0);
     }},
    // Waits for descriptors with masks of signals.
    {"ppoll",
     [] {
       pollfd in{STDIN_FILENO, POLLIN, 0};
       return ppoll(&in, 1, &none, nullptr) >= 0;
     }},
    {"pselect",
     [] {
       fd_set set;
       FD_ZERO(&set);
       FD_SET(STDIN_FILENO, &set);
       return pselect(1, &set, nullptr, nullptr, &none, nullptr) >= 0;
     }},
    {"epoll_pwait",
     [] {
       const int set = connectedSet();
       epoll_event event;
       return epoll_pwait(set, &event, 1, 0, nullptr);
     }},
    // Timers of the kernel, which send signals.
    {"timer_create",
     [] {
       timer_t timer;
       sigevent event{};
       event.sigev_notify = SIGEV_NONE;
       return timer_create(CLOCK_MONOTONIC, &event, &timer);
     }},
    {"setitimer",
     [] {
       const itimerval never{};
       return setitimer(ITIMER_REAL, &never, nullptr);
     }},
    {"alarm", [] { return static_cast<int>(alarm(0)); }},
    {"ualarm", [] { return static_cast<int>(ualarm(0, 0)); }},
    // Calls by which processes that take no part can change something.
    {"popen", [] { return pclose(popen("true", "r")); }},
    {"system", [] { return std::system("true"); }},
    {"fork",
     [] {
       const pid_t child = fork();
       return child == 0 ? (_exit(0), 0) : waitpid(child, nullptr, 0) != child;
     }},
    {"posix_spawn",
     [] {
       pid_t child = 0;
       const int failed = posix_spawn(&child, "/bin/true", nullptr, nullptr, arguments, environ);
       return failed != 0 || waitpid(child, nullptr, 0) != child;
     }},
    {"posix_spawnp",
     [] {
       pid_t child = 0;
       const int failed = posix_spawnp(&child, shell, nullptr, nullptr, arguments, environ);
       return failed != 0 || waitpid(child, nullptr, 0) != child;
     }},
    {"socket", [] { return close(socket(AF_INET, SOCK_DGRAM, 0)); }},
    {"shm_open",
     [] {
       close(shm_open("/move_base_abstract_test", O_CREAT | O_RDWR, 0600));
       return shm_unlink("/move_base_abstract_test");
     }},
    {"shmget",
     [] { return shmctl(shmget(IPC_PRIVATE, 4096, IPC_CREAT | 0600), IPC_RMID, nullptr); }},
    // Queues that other processes can use, and the threads of C11.
    {"mq_open",
     [] {
       const mqd_t queue = mq_open("/move_base_abstract_test", O_CREAT | O_RDWR, 0600, nullptr);
       return mq_close(queue) + mq_unlink("/move_base_abstract_test");
     }},
    {"msgget", [] { return msgctl(msgget(IPC_PRIVATE, IPC_CREAT | 0600), IPC_RMID, nullptr); }},
    {"semget", [] { return semctl(semget(IPC_PRIVATE, 1, IPC_CREAT | 0600), 0, IPC_RMID); }},
    {"thrd_sleep", [] { return thrd_sleep(&none, nullptr); }},
    {"mtx_timedlock",
     [] {
       mtx_init(&mutex, mtx_timed);
       return mtx_timedlock(&mutex, &none);
     }},
    {"cnd_timedwait",
     [] {
       cnd_init(&condition);
       return cnd_timedwait(&condition, &mutex, &none) != thrd_timedout;
     }},
    {"thrd_create",
     [] {
       thrd_t thread;
       thrd_create(
           &thread, [](void*) { return 0; }, nullptr);
       return thrd_join(thread, nullptr);
     }},
    // Information about the system, and memory that is mapped from a file.
    {"mmap", [] { return map(&mmap); }},
    {"mmap64", [] { return map(&mmap64); }},
    {"getloadavg",
     [] {
       double load = 0;
       return getloadavg(&load, 1) != 1;
     }},
    {"sysinfo",
     [] {
       struct sysinfo info;
       return sysinfo(&info);
     }},
    {"/proc", [] { return !std::ifstream("/proc/uptime"); }},
    {"/sys", [] { return close(open("/sys/kernel", O_RDONLY)); }}};

}  // namespace untold_sources
