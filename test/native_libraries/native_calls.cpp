#include "native_calls.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <thread>

#include "../cpp_nodes/untold_sources.h"

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
  int results = 0;
  for (const char* name :
       {"times", "getrusage", "getloadavg", "sysinfo", "timer_create", "setitimer", "alarm",
        "ualarm", "getpid", "popen", "fork", "posix_spawn", "posix_spawnp", "system", "/proc"}) {
    results += untold_sources::all.at(name)();
  }
  close(timerfd_create(CLOCK_MONOTONIC, 0));
  std::ifstream("/dev/null");
  return results == 2 ? "asked" : "";  // times() and getpid() give truths
}
