// A library with a name like TBB's, which does loops as TBB does: with a thread for each core that
// it sees, in which the caller's own waits by giving way until the others have done their part.
#include <pthread.h>
#include <sched.h>

#include <atomic>
#include <vector>

namespace {

std::atomic<int> working{0};

void* work(void* /*unused*/) {
  constexpr unsigned kSteps =
      100'000'000;  // many more than a loop of a hundred sched_yield() takes
  for (volatile unsigned step = 0; step < kSteps; step = step + 1) {
  }
  --working;
  return nullptr;
}

}  // namespace

/** @param wanted number of threads; 0: as many as there are cores. @return number of threads. */
extern "C" int tbb_stand_in_loop(int wanted) {
  cpu_set_t cores;
  sched_getaffinity(0, sizeof cores, &cores);
  const int count = wanted > 0 ? wanted : CPU_COUNT(&cores);
  std::vector<pthread_t> others(static_cast<std::size_t>(count - 1));
  working = count - 1;
  for (pthread_t& other : others) {
    pthread_create(&other, nullptr, &work, nullptr);
  }
  while (working > 0) {
    sched_yield();
  }
  for (const pthread_t other : others) {
    pthread_join(other, nullptr);
  }
  return count;
}
