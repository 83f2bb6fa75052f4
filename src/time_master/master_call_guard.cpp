#include "master_call_guard.h"

#include <ros/console.h>
#include <ros/master.h>
#include <unistd.h>

#include <chrono>

#include "node_probe.h"

namespace move_base_abstract {
namespace {

constexpr std::chrono::milliseconds kGuardGap{1000};      // wall, between two looks
constexpr std::chrono::milliseconds kRetry{100};          // wall
constexpr std::chrono::milliseconds kConnectLimit{2000};  // wall, for a connection
constexpr int kLooks = 3;

bool masterTakesConnections() {
  return canConnect(ros::master::getHost(), ros::master::getPort(), kConnectLimit);
}

[[noreturn]] void endProcess(const char* why) {
  ROS_FATAL("a call to the ROS master at %s does not return: %s", ros::master::getURI().c_str(),
            why);
  _exit(1);  // not exit(), which would wait for the call that hangs
}

}  // namespace

MasterCallGuard::MasterCallGuard(const std::atomic<int>& signal_number)
    : signal_number_(signal_number), thread_([this] { run(); }) {}

MasterCallGuard::~MasterCallGuard() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

bool MasterCallGuard::awaitMaster() {
  for (bool told = false; signal_number_ == 0; told = true) {
    if (masterTakesConnections()) {
      return true;
    }
    if (!told) {
      ROS_WARN("waiting for the ROS master at %s", ros::master::getURI().c_str());
    }
    std::this_thread::sleep_for(kRetry);
  }
  return false;
}

void MasterCallGuard::add(int sections) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    sections_ += sections;
    refusals_ = looks_after_signal_ = 0;
  }
  wake_.notify_all();
}

void MasterCallGuard::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!ending_) {
    if (sections_ == 0) {
      wake_.wait(lock, [this] { return ending_ || sections_ > 0; });
    } else if (!wake_.wait_for(lock, kGuardGap, [this] { return ending_ || sections_ == 0; })) {
      lock.unlock();
      const bool refused = !masterTakesConnections();
      lock.lock();
      look(refused);
    }
  }
}

/**
 * @brief End the process if it is time. Called with the lock, so that a section which ends just now
 * is safe.
 */
void MasterCallGuard::look(bool refused) {
  if (sections_ == 0 || ending_) {
    return;
  }
  refusals_ = refused ? refusals_ + 1 : 0;
  looks_after_signal_ += signal_number_ != 0 ? 1 : 0;
  if (refusals_ >= kLooks) {
    endProcess("it no longer takes connections");
  }
  if (looks_after_signal_ >= kLooks) {
    endProcess("the process was told to end");
  }
}

}  // namespace move_base_abstract
