// The topics on which a participant publishes and listens.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_TOPICS_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_TOPICS_H

#include <ros/node_handle.h>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "copies.h"
#include "exchange.h"
#include "outside.h"

namespace move_base_abstract::lockstep::internal {

class Core;
class Subscription;

using HeaderPtr = boost::shared_ptr<ros::M_string>;

/**
 * @brief A member that publishes on a topic of this node, as its PUBLISHER item has presented it.
 */
struct Sender {
  std::string md5;
  bool latched = false;
  HeaderPtr header;                 // the header that roscpp would have for the connection
  std::optional<std::string> last;  // of a latched topic
};

/** @brief A topic name on which this node publishes, listens, or both. */
struct Topic : SharedTopic {
  int publications = 0;  // handles alive
  bool latched = false;
  bool has_header = false;
  bool excluded = false;  // roscpp alone carries it, outside of lockstep
  bool constant = false;  // messages from outside are the same in every run
  std::uint32_t sequence = 0;
  std::string md5;                             // of what is published
  std::optional<std::string> last;             // latched
  std::set<std::uint32_t> receivers;           // members, by id
  std::multiset<std::string> connected;        // nodes that roscpp has connected, members included
  ros::Publisher outside;                      // roscpp's publisher, while publications > 0
  std::vector<Subscription*> subscriptions;    // alive, in the order of their creation
  std::map<std::uint32_t, Sender> publishers;  // members, by id
  Copies copies;
  Reading reading = std::make_shared<std::size_t>(0);
};

class Publication {
 public:
  Publication(const std::shared_ptr<Core>& core, Topic& topic) : core_(core), topic_(&topic) {}
  ~Publication();
  Publication(const Publication&) = delete;
  Publication& operator=(const Publication&) = delete;

  std::shared_ptr<Core> core() const { return core_.lock(); }
  Topic& topic() { return *topic_; }

 private:
  std::weak_ptr<Core> core_;
  Topic* topic_;  // valid while the core exists
};

class Subscription : public std::enable_shared_from_this<Subscription> {
 public:
  Subscription(const std::shared_ptr<Core>& core, Topic& topic,
               const ros::SubscribeOptions& options);
  ~Subscription();
  Subscription(const Subscription&) = delete;
  Subscription& operator=(const Subscription&) = delete;

  std::shared_ptr<Core> core() const { return core_.lock(); }
  Topic& topic() { return *topic_; }
  const std::string& md5() const { return options_.md5sum; }
  bool hasHeader() const { return options_.helper->hasHeader(); }
  bool takes(const std::string& md5) const {
    return options_.md5sum == "*" || options_.md5sum == md5;
  }

  /** @brief Note that one more message waits in the mail. */
  void expect() { ++waiting_; }
  /**
   * @return whether the next message is to be handled. The queue size keeps only the newest ones.
   */
  bool isWanted();
  /**
   * @brief Hand one message to the callback: from a member as bytes, or from outside as a message.
   */
  void handle(const HeaderPtr& header, const std::string& payload);
  void handle(const ros::MessageEvent<void const>& event);

  /** @brief Let roscpp deliver messages from outside through @p queue. */
  void listenOutside(ros::NodeHandle& node, const std::shared_ptr<OutsideQueue>& queue,
                     const std::string& unresolved, Interceptor::Handler handler);

 private:
  std::weak_ptr<Core> core_;
  Topic* topic_;
  ros::SubscribeOptions options_;
  std::size_t waiting_ = 0;
  std::shared_ptr<OutsideQueue> queue_;  // roscpp keeps a plain pointer to it
  ros::Subscriber outside_;
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_TOPICS_H
