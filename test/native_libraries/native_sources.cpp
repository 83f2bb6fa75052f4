#include "native_sources.h"

#include <fcntl.h>
#include <linux/futex.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/random.h>
#include <sys/select.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/timeb.h>
#include <time.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <fstream>
#include <future>
#include <map>
#include <mutex>
#include <random>
#include <shared_mutex>
#include <sstream>
#include <thread>

#include "native_calls.h"

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

long long ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return now.tv_sec * 1000000000LL + now.tv_nsec;
}

timespec later(clockid_t clock, long long nanoseconds) {
  const long long end = ns(clock) + nanoseconds;
  return {end / 1000000000, end % 1000000000};
}

std::string clocks() {
  std::ostringstream said;
  for (const clockid_t clock :
       {CLOCK_REALTIME, CLOCK_MONOTONIC, CLOCK_BOOTTIME, CLOCK_PROCESS_CPUTIME_ID}) {
    said << ns(clock) << ' ';
  }
  timespec spec{};
  timespec_get(&spec, TIME_UTC);
  timeval value{};
  gettimeofday(&value, nullptr);
  timeb old{};
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
  ftime(&old);  // old programs do
#pragma GCC diagnostic pop
  said << spec.tv_sec << ' ' << spec.tv_nsec << ' ' << value.tv_sec << ' ' << value.tv_usec << ' '
       << time(nullptr) << ' ' << old.time << ' ' << old.millitm << ' ' << clock() << ' '
       << std::chrono::system_clock::now().time_since_epoch().count() << ' '
       << Clock::now().time_since_epoch().count();
  return said.str();
}

/** @return the milliseconds that each of these has taken, by the clock that is seen. */
template <typename... Sleeps>
std::string lasted(Sleeps... sleeps) {
  std::ostringstream said;
  const auto one = [&said](auto sleep) {
    const long long begin = ns(CLOCK_MONOTONIC);
    said << sleep() << ' ' << static_cast<double>(ns(CLOCK_MONOTONIC) - begin) / 1e6 << ", ";
  };
  (one(sleeps), ...);
  return said.str();
}

std::string sleeps() {
  const timespec request{0, 20000000};
  return lasted([] { return usleep(10000); }, [&] { return nanosleep(&request, nullptr); },
                [&] { return clock_nanosleep(CLOCK_REALTIME, 0, &request, nullptr); },
                [] {
                  const timespec end = later(CLOCK_MONOTONIC, 30000000);
                  return clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &end, nullptr);
                },
                [] { return poll(nullptr, 0, 40); },
                [] {
                  timeval timeout{0, 50000};
                  return select(0, nullptr, nullptr, nullptr, &timeout);
                },
                [] {
                  std::this_thread::sleep_for(60ms);
                  std::this_thread::sleep_until(std::chrono::system_clock::now() + 70ms);
                  return sleep(0);
                });
}

int waitForFutex() {
  static int word = 0;
  const timespec end = later(CLOCK_MONOTONIC, 12000000);
  return static_cast<int>(
      syscall(SYS_futex, &word, FUTEX_WAIT_BITSET, 0, &end, nullptr, FUTEX_BITSET_MATCH_ANY));
}

/** @brief What it is waited for is there for the time of the process: nobody gives it. */
struct Never {
  Never() {
    lock = std::unique_lock<std::mutex>(mutex);
    pthread_mutex_lock(&held);
    std::thread([this] {
      pthread_rwlock_wrlock(&shared);
    }).join();  // who has it himself is told so at once
    sem_init(&semaphore, 0, 0);
  }

  std::mutex mutex;
  std::unique_lock<std::mutex> lock;
  std::condition_variable condition;
  std::promise<void> promise;
  std::future<void> future = promise.get_future();
  pthread_cond_t plain = PTHREAD_COND_INITIALIZER;
  pthread_mutex_t held = PTHREAD_MUTEX_INITIALIZER;
  pthread_rwlock_t shared = PTHREAD_RWLOCK_INITIALIZER;
  sem_t semaphore;
};

std::string waits() {
  Never& never = *new Never;
  const auto until = [](int milliseconds) {
    return later(CLOCK_REALTIME, milliseconds * 1000000LL);
  };
  timespec end{};
  return lasted(
      [&] { return never.condition.wait_for(never.lock, 10ms) == std::cv_status::timeout; },
      [&] {
        return never.condition.wait_until(never.lock, std::chrono::system_clock::now() + 20ms) ==
               std::cv_status::timeout;
      },
      [&] { return never.future.wait_for(30ms) == std::future_status::timeout; },
      [&] {
        return never.future.wait_until(std::chrono::system_clock::now() + 40ms) ==
               std::future_status::timeout;
      },
      [&] { return end = until(50), pthread_cond_timedwait(&never.plain, &never.held, &end); },
      [&] { return end = until(60), pthread_mutex_timedlock(&never.held, &end) != 0; },
      [&] { return end = until(7), sem_timedwait(&never.semaphore, &end); },
      [&] {
        return end = later(CLOCK_MONOTONIC, 8000000),
               sem_clockwait(&never.semaphore, CLOCK_MONOTONIC, &end);
      },
      [&] { return end = until(9), pthread_rwlock_timedrdlock(&never.shared, &end) != 0; },
      [&] { return end = until(11), pthread_rwlock_timedwrlock(&never.shared, &end) != 0; },
      &waitForFutex);
}

/** @brief The same by C++'s names, for whatever clock. */
std::string timed() {
  auto& mutex = *new std::timed_mutex;
  auto& shared = *new std::shared_timed_mutex;
  std::thread([&] {
    mutex.lock();
    shared.lock();
  }).join();
  std::promise<void> end;
  std::thread worker([&end] { end.get_future().wait(); });
  timespec until{};
  const std::string said = lasted(
      [&] { return mutex.try_lock_for(10ms); },
      [&] { return mutex.try_lock_until(std::chrono::system_clock::now() + 20ms); },
      [&] { return shared.try_lock_for(30ms); }, [&] { return shared.try_lock_shared_for(40ms); },
      [&] {
        return until = later(CLOCK_REALTIME, 50000000),
               pthread_timedjoin_np(worker.native_handle(), nullptr, &until);
      },
      [&] { return mutex.try_lock_until(Clock::now() - 1h); });
  end.set_value();
  worker.join();
  return said;
}

/** @brief Wait with limits that are never reached: as long as another thread takes. */
std::string given() {
  std::promise<int> promise;
  std::future<int> future = promise.get_future();
  std::thread worker([&promise] { promise.set_value(7); });
  const auto state = future.wait_until(Clock::time_point::max());
  worker.join();
  std::mutex mutex;
  std::unique_lock<std::mutex> lock(mutex);
  bool is_there = false;
  std::condition_variable condition;
  std::thread([&] {
    const std::lock_guard<std::mutex> guard(mutex);
    is_there = true;
    condition.notify_all();
  }).detach();
  return std::to_string(state == std::future_status::ready) +
         std::to_string(condition.wait_until(lock, std::chrono::system_clock::time_point::max(),
                                             [&] { return is_there; }));
}

std::string chance() {
  std::ostringstream said;
  unsigned bytes = 0;
  said << rand() << ' ' << random() << ' ' << drand48() << ' ' << lrand48() << ' ' << mrand48();
  said << ' ' << (getrandom(&bytes, sizeof bytes, 0), bytes) << ' '
       << (getentropy(&bytes, sizeof bytes), bytes);
#if __GLIBC_PREREQ(2, 36)
  said << ' ' << arc4random() << ' ' << (arc4random_buf(&bytes, sizeof bytes), bytes) << ' '
       << arc4random_uniform(1000000);
#endif
  said << ' ' << std::random_device()() << ' ' << std::mt19937(std::random_device()())();
  const int file = open("/dev/urandom", O_RDONLY);
  said << ' ' << (read(file, &bytes, sizeof bytes) == sizeof bytes ? bytes : 0);
  close(file);
  FILE* const stream = fopen("/dev/random", "rb");
  said << ' ' << (fread(&bytes, sizeof bytes, 1, stream) == 1 ? bytes : 0);
  fclose(stream);
  std::ifstream("/dev/urandom").read(reinterpret_cast<char*>(&bytes), sizeof bytes);
  srand(static_cast<unsigned>(time(nullptr)));
  said << ' ' << bytes << ' ' << rand();
  return said.str();
}

std::string seconds() {
  return lasted([] { return sleep(2); });
}

/** @brief Wait for a clock by looking at it. */
std::string spin() {
  const auto begin = Clock::now();
  long looks = 0;
  while (Clock::now() < begin + 3ms) {
    ++looks;
  }
  return std::to_string(looks);
}

/** @brief An anytime search, which takes the time that it is given. */
std::string limit() {
  const auto begin = Clock::now();
  double sum = 0.0;
  while (Clock::now() < begin + 1s) {
    for (int k = 0; k < 20000; ++k) {
      sum += std::sqrt(k);
    }
  }
  return sum > 0.0 ? "over" : "";
}

/** @brief A thread of the library's own waits, draws, and lets its caller wait. */
std::string threads() {
  std::string said;
  std::thread([&said] {
    const auto begin = Clock::now();
    while (Clock::now() < begin + 30ms) {
      std::this_thread::sleep_for(10ms);
    }
    unsigned drawn = 0;
    getrandom(&drawn, sizeof drawn, 0);
    said = std::to_string((Clock::now() - begin) / 1ms) + ' ' + std::to_string(drawn);
  }).join();
  return said;
}

}  // namespace

std::string ask(const std::string& topic) {
  const std::map<std::string, std::string (*)()> topics = {
      {"clocks", &clocks},   {"sleeps", &sleeps},   {"waits", &waits}, {"chance", &chance},
      {"timed", &timed},     {"given", &given},     {"spin", &spin},   {"limit", &limit},
      {"threads", &threads}, {"seconds", &seconds}, {"files", &files}, {"strays", &strays},
      {"untold", &untold}};
  return topics.at(topic)();
}

/** For ctypes. */
extern "C" void ask_text(const char* topic, char* text, std::size_t size) {
  snprintf(text, size, "%s", ask(topic).c_str());
}
