/// Prints the number of cores that it sees, that it has, and that its child processes have.
#include <pthread.h>
#include <ros/ros.h>
#include <sched.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace shim_cores {

namespace {

void tell(const char* what, const cpu_set_t& cores) {
  std::printf("%s %d\n", what, CPU_COUNT(&cores));
  std::fflush(stdout);
}

/** @return the cores by the system call, which lockstep does not replace. */
cpu_set_t had() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  syscall(SYS_sched_getaffinity, 0, sizeof cores, &cores);
  return cores;
}

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "cores");
  ros::NodeHandle node;
  ros::Duration(1.0).sleep();
  tell("has", had());
  cpu_set_t cores;
  sched_getaffinity(0, sizeof cores, &cores);
  tell("sees", cores);
  pthread_getaffinity_np(pthread_self(), sizeof cores, &cores);
  tell("thread_sees", cores);
  const pid_t child = fork();
  if (child == 0) {
    tell("fork", had());
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  unsetenv("OMP_NUM_THREADS");  // nproc believes these, which the launcher has set
  unsetenv("OMP_THREAD_LIMIT");
  std::system("echo system $(nproc)");
  char line[80] = "";
  FILE* const pipe = popen("echo popen $(nproc)", "r");
  std::printf("%s", std::fgets(line, sizeof line, pipe));
  std::fflush(stdout);
  pclose(pipe);
  char shell[] = "sh", option[] = "-c", command[] = "echo spawn $(nproc)";
  char* words[] = {shell, option, command, nullptr};
  pid_t spawned = 0;
  posix_spawnp(&spawned, shell, nullptr, nullptr, words, environ);
  waitpid(spawned, nullptr, 0);
  ros::Duration(1.0).sleep();  // a long round has all cores for its rest
  tell("has", had());
  sched_setaffinity(0, sizeof cores, &cores);
  tell("chose", had());
  CPU_ZERO(&cores);
  CPU_SET(sched_getcpu(), &cores);
  pthread_setaffinity_np(pthread_self(), sizeof cores, &cores);
  sched_getaffinity(0, sizeof cores, &cores);
  tell("chose", cores);
  return 0;
}

}  // namespace shim_cores
