#include "detach_from_clock.h"

#include <XmlRpc.h>
#include <ros/callback_queue.h>
#include <ros/master.h>
#include <ros/names.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <ros/topic_manager.h>
#include <ros/xmlrpc_manager.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>

#include "move_base_abstract/lockstep_participant.h"

namespace ros {
CallbackQueuePtr getInternalCallbackQueue();  // exported by roscpp, but not in its headers
}

namespace move_base_abstract::lockstep::internal {
namespace {

/** @brief Runs in roscpp's internal queue after all callbacks that /clock has put there. */
class Marker : public ros::CallbackInterface {
 public:
  CallResult call() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_passed_ = true;
    passed_.notify_all();
    return Success;
  }
  void wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    passed_.wait_for(lock, std::chrono::seconds(5), [this] { return is_passed_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable passed_;
  bool is_passed_ = false;
};

/** @brief Tell roscpp that no node publishes @p topic, by the slave API, as a ROS master does. */
bool endConnections(const std::string& topic) {
  const std::string& uri = ros::XMLRPCManager::instance()->getServerURI();
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(uri, host, port)) {
    return false;
  }
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue request, response;
  request[0] = ros::this_node::getName();
  request[1] = topic;
  request[2].setSize(0);
  return client.execute("publisherUpdate", request, response) && !client.isFault();
}

}  // namespace

void detachFromClock() {
  const std::string clock = ros::names::resolve("/clock");
  ros::V_string subscribed;
  ros::TopicManager::instance()->getSubscribedTopics(subscribed);
  if (std::find(subscribed.begin(), subscribed.end(), clock) == subscribed.end()) {
    return;
  }
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = ros::this_node::getName();
  request[1] = clock;
  request[2] = ros::XMLRPCManager::instance()->getServerURI();
  if (!ros::master::execute("unregisterSubscriber", request, response, payload, false) ||
      !endConnections(clock)) {
    throw Error("lockstep: node " + ros::this_node::getName() + " could not be taken off " + clock);
  }
  const auto marker = boost::make_shared<Marker>();
  ros::getInternalCallbackQueue()->addCallback(marker);
  marker->wait();
}

}  // namespace move_base_abstract::lockstep::internal
