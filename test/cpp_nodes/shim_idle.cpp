// A program that has nothing left to do. ~what chooses whether its threads wait for work, for each
// other, or for a promise.
#include <ros/ros.h>

#include <condition_variable>
#include <deque>
#include <future>
#include <map>
#include <mutex>
#include <string>
#include <thread>

namespace shim_idle {

namespace {

/** Workers take jobs from a queue, and main waits for their end, which never comes. */
void jobs() {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<int> work = {1, 2, 3};
  const auto take = [&] {
    while (true) {
      std::unique_lock<std::mutex> lock(mutex);
      changed.wait(lock, [&] { return !work.empty(); });
      work.pop_front();
      lock.unlock();
      ros::Duration(1.0).sleep();
    }
  };
  std::thread first(take);
  std::thread second(take);
  first.join();
  second.join();
}

/** Each of two threads has a lock, and wants the lock of the other. */
void locks() {
  std::mutex a;
  std::mutex b;
  const auto take = [](std::mutex& first, std::mutex& second) {
    const std::lock_guard<std::mutex> has(first);
    ros::Duration(1.0).sleep();
    const std::lock_guard<std::mutex> wants(second);
  };
  std::thread one([&] { take(a, b); });
  std::thread other([&] { take(b, a); });
  one.join();
  other.join();
}

/** The main thread waits for a promise that is never kept. */
void promise() {
  std::promise<int> promised;
  promised.get_future().wait();
}

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "idle");
  ros::NodeHandle own("~");
  ros::AsyncSpinner spinner(2);
  spinner.start();
  const std::map<std::string, void (*)()> all = {
      {"jobs", &jobs}, {"locks", &locks}, {"promise", &promise}};
  all.at(own.param<std::string>("what", ""))();
  return 0;
}

}  // namespace shim_idle
