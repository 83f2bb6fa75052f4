#include "native_calls.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/sysinfo.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <sys/times.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <thread>

// What programs call that are compiled with checks (_FORTIFY_SOURCE).
extern "C" int __open_2(const char* path, int flags);
extern "C" int __open64_2(const char* path, int flags);
extern "C" double omp_get_wtime();

namespace {

unsigned readFrom(int file) {
  unsigned bytes = 0;
  const bool is_read = read(file, &bytes, sizeof bytes) == sizeof bytes;
  close(file);
  return is_read ? bytes : 0;
}

unsigned readFrom(FILE* file) {
  unsigned bytes = 0;
  const bool is_read = fread(&bytes, sizeof bytes, 1, file) == 1;
  fclose(file);
  return is_read ? bytes : 0;
}

/** @brief Have the kernel wake the program, later than it lives. */
void askForSignals() {
  constexpr int kLong = 900;  // s
  signal(SIGALRM, SIG_IGN);
  timer_t timer{};
  timer_create(CLOCK_MONOTONIC, nullptr, &timer);
  timer_delete(timer);
  const itimerval value{{0, 0}, {kLong, 0}};
  setitimer(ITIMER_REAL, &value, nullptr);
  alarm(kLong);
  ualarm(900000, 0);
  alarm(0);
}

void startProcesses() {
  const pid_t child = fork();
  if (child == 0) {
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  char name[] = "true";
  char* const arguments[] = {name, nullptr};
  pid_t spawned = 0;
  posix_spawn(&spawned, "/bin/true", nullptr, nullptr, arguments, environ);
  waitpid(spawned, nullptr, 0);
  posix_spawnp(&spawned, "true", nullptr, nullptr, arguments, environ);
  waitpid(spawned, nullptr, 0);
}

}  // namespace

std::string files() {
  constexpr const char* kPath = "/dev/urandom";
  std::ostringstream said;
  said << readFrom(open(kPath, O_RDONLY)) << ' ' << readFrom(open64(kPath, O_RDONLY)) << ' '
       << readFrom(openat(AT_FDCWD, kPath, O_RDONLY)) << ' '
       << readFrom(openat64(AT_FDCWD, kPath, O_RDONLY)) << ' '
       << readFrom(__open_2(kPath, O_RDONLY)) << ' ' << readFrom(__open64_2(kPath, O_RDONLY)) << ' '
       << readFrom(fopen(kPath, "rb")) << ' ' << readFrom(fopen64("/dev/random", "rb"));
  return said.str();
}

std::string strays() {
  std::ostringstream said;
  std::thread([&said] {
    said << (rand() >= 0) << (random() >= 0) << (drand48() >= 0.0) << (lrand48() >= 0)
         << (mrand48() != 0);
    const int file = open("/dev/urandom", O_RDONLY);
    close(file);
  }).join();
  double lasted = 0.0;
#pragma omp parallel num_threads(2) reduction(max : lasted)
  {
    const double begin = omp_get_wtime();
    lasted = omp_get_wtime() - begin;
  }
  said << ' ' << lasted;
  return said.str();
}

std::string untold() {
  tms spent{};
  times(&spent);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  double load = 0.0;
  const int loads = getloadavg(&load, 1);
  struct sysinfo info {};
  sysinfo(&info);
  close(timerfd_create(CLOCK_MONOTONIC, 0));
  askForSignals();
  const std::string pid = std::to_string(getpid());
  FILE* const output = popen("true", "r");
  pclose(output);
  startProcesses();
  std::ifstream("/proc/uptime");
  std::ifstream("/dev/null");
  return loads == 1 && pid.size() > 1 && system("true") == 0 ? "asked" : "";
}
