// Objects on the heap, in sets that are ordered by address. Callbacks of an AsyncSpinner and
// threads make them, and messages that are kept are among them. It publishes the order on "told".
#include <linux/futex.h>
#include <malloc.h>
#include <pthread.h>
#include <ros/ros.h>
#include <semaphore.h>
#include <std_msgs/String.h>
#include <std_srvs/Empty.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <set>
#include <shared_mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "teller.h"

namespace {

struct Robot {
  int number = 0;
  double places[6] = {};
};

std::unique_ptr<Teller> teller;
std::mutex mutex;
std::shared_mutex readers;

/** @brief Robots and messages in the order of addresses; callbacks of several topics add them. */
class Team {
 public:
  void hear(const std_msgs::String::ConstPtr& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    auto robot = boost::make_shared<Robot>();
    robot->number = ++made_;
    robots_.insert(robot);
    texts_.insert(message);
    ROS_INFO_STREAM("robot " << made_ << " hears " << message->data);
    if (robots_.size() > 6) {
      robots_.erase(std::next(robots_.begin(), generator_() % robots_.size()));
      texts_.erase(std::next(texts_.begin(), generator_() % texts_.size()));
    }
    blocks_[made_ % 8] = std::vector<char>(generator_() % 5000 + made_ % 100000, 'x');
    std::ostringstream order;
    for (const auto& one : robots_) {
      order << one->number << '@' << one.get() << ' ';
    }
    for (const auto& text : texts_) {
      order << text->data << '@' << text.get() << ' ';
    }
    teller->say(order.str());
  }

 private:
  std::mutex mutex_;
  std::mt19937 generator_{1};
  std::set<boost::shared_ptr<Robot>> robots_;
  std::set<std_msgs::String::ConstPtr> texts_;
  std::map<int, std::vector<char>> blocks_;
  int made_ = 0;
};

void spinners() {
  ros::NodeHandle node;
  Team team;
  std::vector<ros::Subscriber> subscribers;
  for (const std::string topic : {"ticks", "others"}) {
    const boost::function<void(const std_msgs::String::ConstPtr&)> callback =
        [&team](const std_msgs::String::ConstPtr& message) {
          ros::Duration(0.01).sleep();
          team.hear(message);
        };
    subscribers.push_back(node.subscribe<std_msgs::String>(topic, 3, callback));
  }
  ros::AsyncSpinner spinner(3);
  spinner.start();
  ros::Duration(5.5).sleep();
  spinner.stop();
}

/** Allocate memory in each way, and free it in another thread. */
void calls() {
  std::ostringstream told;
  void* aligned = nullptr;
  int failed = posix_memalign(&aligned, 4096, 100);
  std::vector<void*> all = {
      malloc(0), malloc(40),      calloc(1000, 1000),       memalign(64, 10), aligned_alloc(32, 64),
      aligned,   malloc(1 << 20), realloc(malloc(20), 2000)};
  for (void* const one : all) {
    told << one << ' ' << (malloc_usable_size(one) > 0) << ' ';
  }
  const auto* const zeros = static_cast<const char*>(all[2]);
  told << failed << ' ' << std::string(zeros, zeros + 1000000).find_first_not_of('\0') << ' ';
  std::thread([&all] {
    thread_local std::string late = "what is given back when the thread has ended";
    late += '.';
    for (void* const one : all) {
      free(one);
    }
  }).join();
  told << malloc(40) << ' ' << malloc(1 << 20);
  teller->say(told.str());
  auto* const used = static_cast<char*>(memset(malloc(3000), 1, 3000));
  free(used);
  const auto* const again = static_cast<char*>(malloc(3000));  // which nothing has written yet
  teller->say("again " + std::to_string(again == used) + ' ' +
              std::to_string(std::count(again, again + 3000, '\0')));
}

/** @return the bytes that are allocated on libc's heap. */
std::size_t handedOut() {
#if defined(__GLIBC_PREREQ) && __GLIBC_PREREQ(2, 33)
  return mallinfo2().uordblks;
#else
  return static_cast<std::size_t>(mallinfo().uordblks);
#endif
}

/** Tell how much memory is left of threads that have ended. */
void threads() {
  constexpr int kThreads = 2000;
  const auto make = [](int count) {
    for (int k = 0; k < count; ++k) {
      std::thread([] {}).join();
      std::thread([] {}).detach();
      ros::Duration(0.001).sleep();
    }
  };
  make(100);
  const std::size_t before = handedOut();
  make(kThreads / 2);
  const std::size_t after = handedOut();
  teller->say(after < before + 10 * kThreads ? "threads leave nothing"
                                             : "threads leave " + std::to_string(after - before));
}

/** The main thread does @p look again and again until another thread changes @p word. */
void spins(std::atomic<int>* word, const std::function<void()>& look) {
  *word = 0;
  std::thread thread([&] {
    const std::lock_guard<std::mutex> lock(mutex);
    const std::lock_guard<std::shared_mutex> writer(readers);
    ros::Duration(0.5).sleep();
    *word = 1;
    syscall(SYS_futex, word, FUTEX_WAKE, 1, nullptr, nullptr, 0);
    teller->say("sets it");
  });
  ros::Duration(0.1).sleep();
  while (*word == 0) {
    look();
  }
  teller->say("sees it " + std::to_string(ros::Time::now().toNSec() / 10000000));
  thread.join();
}

bool doNothing(std_srvs::Empty::Request&, std_srvs::Empty::Response&) { return true; }

/** Loops that wait by calls which do not wait. */
void ways(ros::NodeHandle& node) {
  std::atomic<int> word{0};
  sem_t never;
  sem_init(&never, 0, 0);
  pthread_spinlock_t taken;
  pthread_spin_init(&taken, 0);
  pthread_spin_lock(&taken);
  const auto server = node.advertiseService("nothing", &doNothing);
  auto client = node.serviceClient<std_srvs::Empty>("nothing");
  ros::AsyncSpinner spinner(1);
  spinner.start();
  std_srvs::Empty call;
  spins(&word, [] { std::this_thread::yield(); });
  spins(&word, [] { usleep(0); });
  spins(&word, [] { syscall(SYS_sched_yield); });
  spins(&word, [] { mutex.try_lock(); });
  spins(&word, [] { readers.try_lock(); });
  spins(&word, [] { readers.try_lock_shared(); });
  spins(&word, [&] { pthread_spin_trylock(&taken); });
  spins(&word, [&] { sem_trywait(&never); });
  spins(&word, [&] { syscall(SYS_futex, &word, FUTEX_WAIT, 0, nullptr, nullptr, 0); });
  spins(&word, [&] { client.call(call); });
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "heap");
  ros::NodeHandle node;
  ros::NodeHandle own("~");
  teller = std::make_unique<Teller>("told");
  ros::Duration(0.5).sleep();
  const std::string what = own.param<std::string>("what", "spinners");
  if (what == "spinners") {
    spinners();
    calls();
  } else if (what == "threads") {
    threads();
  } else if (what == "ways") {
    ways(node);
  } else {
    std::atomic<int> word{0};
    spins(&word, [] {});
  }
  ros::Duration(0.5).sleep();
  own.setParam("done", true);
  return 0;
}
