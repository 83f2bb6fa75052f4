// Objects on the heap, in sets that are ordered by address. Callbacks of an AsyncSpinner and
// threads make them, and messages that are kept are among them. It publishes the order on "told".
#include <malloc.h>
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <stdlib.h>
#include <unistd.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <set>
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

/** The main thread spins until another thread changes a variable. */
void spins(const std::string& how) {
  std::atomic<bool> is_set{false};
  std::thread thread([&] {
    ros::Duration(0.5).sleep();
    is_set = true;
    teller->say("sets it");
  });
  const bool gives_way = how == "yields";
  const bool naps = how == "naps";
  while (!is_set) {
    if (gives_way) {
      std::this_thread::yield();
    } else if (naps) {
      usleep(0);
    }
  }
  teller->say("sees it " + std::to_string(ros::Time::now().toNSec() / 10000000));
  thread.join();
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
  } else {
    spins(what);
  }
  ros::Duration(0.5).sleep();
  own.setParam("done", true);
  return 0;
}
