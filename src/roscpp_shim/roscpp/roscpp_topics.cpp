// Replaces the functions of roscpp that advertise, publish, subscribe, and receive messages.
#include <ros/advertise_options.h>
#include <ros/names.h>
#include <ros/node_handle.h>
#include <ros/poll_set.h>
#include <ros/publication.h>
#include <ros/subscribe_options.h>
#include <ros/topic.h>
#include <ros/topic_manager.h>

#include <algorithm>
#include <mutex>
#include <string>
#include <utility>

#include "roscpp_shim/delivery.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/node.h"
#include "roscpp_shim/parameters.h"
#include "roscpp_shim/topics.h"
#include "roscpp_shim/turn.h"
#include "roscpp_shim/waits.h"

namespace wire = move_base_abstract::wire;

namespace {

/** @brief While this object lives, this library takes out what the thread queues with roscpp. */
class Publishing {
 public:
  explicit Publishing(bool is_app) { is_under_way = is_app; }
  ~Publishing() { is_under_way = false; }
  static thread_local bool is_under_way;
};
thread_local bool Publishing::is_under_way = false;

}  // namespace

namespace ros {

bool TopicManager::advertise(const AdvertiseOptions& options,
                             const SubscriberCallbacksPtr& callbacks) {
  static auto* const function =
      shim::real(&TopicManager::advertise, "ros::TopicManager::advertise");
  const bool is_app = shim::turn().enter() && shim::isManaged(options.topic);
  const shim::Inside inside;
  const bool is_done = function(this, options, callbacks);
  if (is_app && is_done) {
    shim::Topic& topic = shim::topics().of(options.topic);
    if (!std::exchange(topic.is_advertised, true)) {
      shim::node().append(wire::Advertise{topic.number, 0, topic.name, options.datatype,
                                          options.md5sum, options.latch,
                                          options.message_definition});
    }
  }
  return is_done;
}

bool TopicManager::unadvertise(const std::string& name, const SubscriberCallbacksPtr& callbacks) {
  static auto* const function =
      shim::real(&TopicManager::unadvertise, "ros::TopicManager::unadvertise");
  const bool is_app = shim::turn().enter() && shim::isManaged(name);
  const bool is_done = function(this, name, callbacks);
  if (is_app && !lookupPublication(name)) {
    shim::Topic& topic = shim::topics().of(name);
    topic.receivers.clear();
    if (std::exchange(topic.is_advertised, false)) {
      shim::node().append(wire::Unadvertise{topic.number});
    }
  }
  return is_done;
}

void TopicManager::publish(const std::string& name,
                           const boost::function<SerializedMessage(void)>& serialize,
                           SerializedMessage& message) {
  static auto* const function =
      shim::real<void(TopicManager*, const std::string&,
                      const boost::function<SerializedMessage(void)>&, SerializedMessage&)>(
          "ros::TopicManager::publish");
  const bool is_app = shim::turn().enter() && shim::isManaged(name);
  {
    const Publishing publishing(is_app);  // roscpp's thread need not be woken
    const shim::Beside beside;            // it sends and frees the messages for onlookers
    function(this, name, serialize, message);
  }
  if (!is_app) {
    return;
  }
  shim::Turn::self()->has_acted = true;
  // Now, and not in roscpp's thread, because the message is a part of this round.
  const shim::Inside inside;
  const PublicationPtr publication = lookupPublication(name);
  if (publication) {
    shim::topics().broadcast = publication->isLatched() ? nullptr : &shim::topics().of(name);
    shim::topics().is_sent = false;
    publication->processPublishQueue();
    shim::topics().broadcast = nullptr;
  }
}

void PollSet::signal() {
  static auto* const function = shim::real(&PollSet::signal, "ros::PollSet::signal");
  if (!Publishing::is_under_way) {
    function(this);
  }
}

void TopicManager::processPublishQueues() {
  const boost::recursive_mutex::scoped_lock lock(advertised_topics_mutex_);
  for (const PublicationPtr& publication : advertised_topics_) {
    if (!shim::isManaged(publication->getName())) {
      publication->processPublishQueue();
    }
  }
}

bool TopicManager::subscribe(const SubscribeOptions& options) {
  static auto* const function =
      shim::real(&TopicManager::subscribe, "ros::TopicManager::subscribe");
  if (shim::isStarting() && options.topic == names::resolve("/clock")) {
    return true;  // roscpp's own: grants set the time, and a message may be ahead of them
  }
  const bool is_app = shim::turn().enter() && shim::isManaged(options.topic);
  const shim::Inside inside;
  const bool is_done = function(this, options);
  if (is_app && is_done) {
    shim::Topic& topic = shim::topics().of(options.topic);
    if (!std::exchange(topic.is_subscribed, true)) {
      shim::node().append(wire::Subscribe{topic.number, 0, topic.name, options.md5sum});
    }
    shim::noteSubscription(topic, options);
  }
  return is_done;
}

bool TopicManager::unsubscribe(const std::string& name,
                               const SubscriptionCallbackHelperPtr& helper) {
  static auto* const function =
      shim::real(&TopicManager::unsubscribe, "ros::TopicManager::unsubscribe");
  const bool is_app = shim::turn().enter() && shim::isManaged(name);
  const bool is_done = function(this, name, helper);
  if (is_app && !shim::subscriptionTo(name)) {
    shim::Topic& topic = shim::topics().of(name);
    topic.senders.clear();
    if (std::exchange(topic.is_subscribed, false)) {
      shim::node().append(wire::Unsubscribe{topic.number});
    }
    shim::forgetSubscription(topic);
  }
  return is_done;
}

size_t TopicManager::getNumSubscribers(const std::string& name) {
  static auto* const function =
      shim::real(&TopicManager::getNumSubscribers, "ros::TopicManager::getNumSubscribers");
  if (shim::turn().enter() && shim::isManaged(name)) {
    return shim::topics().of(name).receivers.size();  // onlookers do not count
  }
  return function(this, name);
}

uint32_t Subscription::handleMessage(const SerializedMessage& message, bool serialized, bool nocopy,
                                     const boost::shared_ptr<M_string>& header,
                                     const PublisherLinkPtr& link) {
  if (!shim::takesPart() || nocopy) {
    return shim::handleMessage()(this, message, serialized, nocopy, header, link);
  }
  const bool is_managed = shim::isManaged(name_);
  if (is_managed && shim::node().membership().isMember(link->getCallerID())) {
    return 0;  // it comes with a grant; this is the copy for nodes that do not take part
  }
  shim::Input input;
  input.enter = [weak = boost::weak_ptr<Subscription>(shared_from_this()), message, header, link] {
    if (const auto alive = weak.lock()) {
      shim::handleMessage()(alive.get(), message, true, false, header, link);
    }
  };
  if (is_managed) {
    input.label = "a message on " + name_ + " came from " + link->getCallerID() +
                  ", which does not take part";
  }
  input.is_urgent = is_managed;
  shim::node().fromOutside(std::move(input));
  return 0;
}

void Subscription::addLocalConnection(const PublicationPtr& publication) {
  static auto* const function =
      shim::real(&Subscription::addLocalConnection, "ros::Subscription::addLocalConnection");
  if (!shim::isManaged(name_)) {
    function(this, publication);
  }
}

bool Subscription::negotiateConnection(const std::string& uri) {
  static auto* const function =
      shim::real(&Subscription::negotiateConnection, "ros::Subscription::negotiateConnection");
  return (shim::isManaged(name_) && shim::node().membership().isMemberAt(uri)) ||
         function(this, uri);
}

void Publication::addSubscriberLink(const SubscriberLinkPtr& link) {
  static auto* const function =
      shim::real(&Publication::addSubscriberLink, "ros::Publication::addSubscriberLink");
  const bool is_ours = shim::isMemberLink(link);
  if (!is_ours && shim::isManaged(name_) &&
      shim::node().membership().isMember(link->getDestinationCallerID())) {
    const std::lock_guard<shim::PlainMutex> lock(shim::topics().silent_mutex);
    shim::topics().silent.push_back(link);
  } else {
    function(this, link);
  }
}

void Publication::peerConnect(const SubscriberLinkPtr& link) {
  static auto* const function =
      shim::real(&Publication::peerConnect, "ros::Publication::peerConnect");
  if (shim::isMemberLink(link) || !shim::isManaged(name_)) {
    function(this, link);
  }
}

void Publication::peerDisconnect(const SubscriberLinkPtr& link) {
  static auto* const function =
      shim::real(&Publication::peerDisconnect, "ros::Publication::peerDisconnect");
  if (shim::isMemberLink(link) || !shim::isManaged(name_)) {
    function(this, link);
  }
}

void Publication::removeSubscriberLink(const SubscriberLinkPtr& link) {
  static auto* const function =
      shim::real(&Publication::removeSubscriberLink, "ros::Publication::removeSubscriberLink");
  function(this, link);
  const std::lock_guard<shim::PlainMutex> lock(shim::topics().silent_mutex);
  auto& silent = shim::topics().silent;
  silent.erase(std::remove(silent.begin(), silent.end(), link), silent.end());
}

namespace topic {
namespace {

/** After this many waits at one instant, they count as a loop that looks. */
constexpr unsigned kMessages = 100;

}  // namespace

void waitForMessageImpl(SubscribeOptions& options, const boost::function<bool(void)>& is_ready,
                        NodeHandle& node, Duration timeout) {
  static auto* const function = shim::real(&waitForMessageImpl, "ros::topic::waitForMessageImpl");
  if (shim::turn().holds()) {  // a message that is stored is there at once, again and again
    shim::countRepeated(&shim::Turn::self()->messages, kMessages, 0, "waitForMessage()");
  }
  bool is_of_participants = false;
  const std::string name = node.resolveName(options.topic);
  const boost::function<bool(void)> look = [&] {
    is_of_participants =
        is_of_participants || (shim::turn().holds() && !shim::topics().of(name).senders.empty());
    return is_ready();
  };
  function(options, look, node, timeout);
  if (!is_ready() && !is_of_participants && ros::ok() && shim::turn().holds()) {
    shim::tellInVain("a message on " + name);
  }
}

}  // namespace topic
}  // namespace ros
