// Topics between participants, in the place of roscpp's connections. roscpp's own publications and
// subscriptions stay in use: each has one link more for every participant at the other end.
#include <ros/connection_manager.h>
#include <ros/names.h>
#include <ros/param.h>
#include <ros/poll_manager.h>
#include <ros/publication.h>
#include <ros/publisher_link.h>
#include <ros/subscribe_options.h>
#include <ros/subscriber_link.h>
#include <ros/subscription.h>
#include <ros/topic_manager.h>

#include <algorithm>
#include <cstring>

#include "exchange.h"
#include "node.h"
#include "real.h"
#include "turn.h"

namespace move_base_abstract::shim {
namespace {

/** @brief Gives a member away that is private to roscpp: an instantiation may name it. */
template <typename Tag, typename Tag::Member member>
struct Open {
  friend typename Tag::Member open(Tag) { return member; }
};

#define MOVE_BASE_ABSTRACT_OPEN(tag, type, member) \
  struct tag {                                     \
    using Member = type;                           \
    friend Member open(tag);                       \
  };                                               \
  template struct Open<tag, &member>

using Subscriptions = ros::L_Subscription ros::TopicManager::*;
using SubscriptionsMutex = boost::mutex ros::TopicManager::*;
using Publications = ros::V_Publication ros::TopicManager::*;
using AddPublisherLink = void (ros::Subscription::*)(const ros::PublisherLinkPtr&);
using PublisherLinks = std::vector<ros::PublisherLinkPtr> ros::Subscription::*;
using PublisherLinksMutex = boost::mutex ros::Subscription::*;
using SubscriberLinks = ros::V_SubscriberLink ros::Publication::*;
using SubscriberLinksMutex = boost::mutex ros::Publication::*;

MOVE_BASE_ABSTRACT_OPEN(OfSubscriptions, Subscriptions, ros::TopicManager::subscriptions_);
MOVE_BASE_ABSTRACT_OPEN(OfSubscriptionsMutex, SubscriptionsMutex, ros::TopicManager::subs_mutex_);
MOVE_BASE_ABSTRACT_OPEN(OfPublications, Publications, ros::TopicManager::advertised_topics_);
MOVE_BASE_ABSTRACT_OPEN(OfAddPublisherLink, AddPublisherLink, ros::Subscription::addPublisherLink);
MOVE_BASE_ABSTRACT_OPEN(OfPublisherLinks, PublisherLinks, ros::Subscription::publisher_links_);
MOVE_BASE_ABSTRACT_OPEN(OfPublisherLinksMutex, PublisherLinksMutex,
                        ros::Subscription::publisher_links_mutex_);
MOVE_BASE_ABSTRACT_OPEN(OfSubscriberLinks, SubscriberLinks, ros::Publication::subscriber_links_);
MOVE_BASE_ABSTRACT_OPEN(OfSubscriberLinksMutex, SubscriberLinksMutex,
                        ros::Publication::subscriber_links_mutex_);

class MemberSubscriber;
class MemberPublisher;

struct Topic {
  std::uint32_t number = 0;
  std::string name;
  bool is_advertised = false;
  bool is_subscribed = false;
  std::map<std::uint32_t, boost::shared_ptr<MemberSubscriber>> receivers;  // by participant
  std::map<std::uint32_t, boost::shared_ptr<MemberPublisher>> senders;     // by participant
};

using HandleMessage = std::uint32_t(ros::Subscription*, const ros::SerializedMessage&, bool, bool,
                                    const boost::shared_ptr<ros::M_string>&,
                                    const ros::PublisherLinkPtr&);

HandleMessage* handleMessage() {
  static HandleMessage* const function = real<HandleMessage>(
      "_ZN3ros12Subscription13handleMessageERKNS_17SerializedMessageEbbRKN5boost10shared_"
      "ptrISt3mapINSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEESC_St4lessISC_ESaISt4pairIKSC"
      "_SC_EEEEERKNS5_INS_13PublisherLinkEEE");
  return function;
}

/** @brief Topics by number and name; the lock is for readers in roscpp's own threads. */
class Topics {
 public:
  Topic& of(const std::string& name) {
    const auto [at, is_new] =
        numbers_.emplace(name, static_cast<std::uint32_t>(numbers_.size() + 1));
    Topic& topic = topics_[at->second];
    topic.number = at->second;
    topic.name = name;
    return topic;
  }
  Topic* of(std::uint32_t number) {
    const auto found = topics_.find(number);
    return found == topics_.end() ? nullptr : &found->second;
  }

  /** The message that is being published to all, and whether it is in the report already. */
  const Topic* broadcast = nullptr;
  bool is_sent = false;
  /** Links of roscpp's to participants: kept, so that they are not made again, but unused. */
  std::vector<ros::SubscriberLinkPtr> silent;
  PlainMutex silent_mutex;

 private:
  std::map<std::string, std::uint32_t> numbers_;
  std::map<std::uint32_t, Topic> topics_;
};

Topics& topics() {
  static Topics* const instance = new Topics;
  return *instance;
}

std::set<std::string>& excludedTopics() {
  static auto* const names =
      new std::set<std::string>{"/clock", "/rosout", "/rosout_agg", "/statistics"};
  return *names;
}

/** @brief A publication's link to a participant that listens: it writes into the report. */
class MemberSubscriber : public ros::SubscriberLink {
 public:
  MemberSubscriber(const Topic& topic, std::uint32_t member) : own_topic_(topic), member_(member) {
    topic_ = topic.name;
    destination_caller_id_ = node().nameOf(member);
    connection_id_ = ros::ConnectionManager::instance()->getNewConnectionID();
    parent_ = ros::TopicManager::instance()->lookupPublication(topic.name);
  }

  void enqueueMessage(const ros::SerializedMessage& message, bool, bool) override {
    if (!message.buf) {
      return;
    }
    const bool to_all = topics().broadcast == &own_topic_;
    if (to_all && topics().is_sent) {
      return;
    }
    topics().is_sent = to_all;
    constexpr std::size_t kLength = 4;  // of the message, before it
    const auto* const bytes = reinterpret_cast<const char*>(message.buf.get());
    node().append(wire::Send{own_topic_.number,
                             0,
                             to_all ? 0 : member_,
                             {bytes + kLength, message.num_bytes - kLength}});
    stats_.bytes_sent_ += message.num_bytes;
    stats_.message_data_sent_ += message.num_bytes;
    ++stats_.messages_sent_;
  }

  void drop() override {}
  std::string getTransportType() override { return "LOCKSTEP"; }
  std::string getTransportInfo() override { return "lockstep, through the time master"; }

 private:
  const Topic& own_topic_;
  std::uint32_t member_;
};

/** @brief A subscription's link to a participant that publishes. */
class MemberPublisher : public ros::PublisherLink {
 public:
  MemberPublisher(const ros::SubscriptionPtr& subscription, std::uint32_t member)
      : PublisherLink(subscription, node().uriOf(member), ros::TransportHints()) {}

  boost::shared_ptr<ros::M_string> values() { return header_.getValues(); }
  void count(std::size_t bytes) {
    stats_.bytes_received_ += bytes;
    ++stats_.messages_received_;
  }

  void handleMessage(const ros::SerializedMessage&, bool, bool) override {}
  void drop() override {
    if (const auto parent = parent_.lock()) {
      parent->removePublisherLink(shared_from_this());
    }
  }
  std::string getTransportType() override { return "LOCKSTEP"; }
  std::string getTransportInfo() override { return "lockstep, through the time master"; }
};

std::vector<ros::SubscriptionPtr> allSubscriptions() {
  ros::TopicManager& manager = *ros::TopicManager::instance();
  const boost::mutex::scoped_lock lock(manager.*open(OfSubscriptionsMutex()));
  const auto& all = manager.*open(OfSubscriptions());
  return {all.begin(), all.end()};
}

ros::SubscriptionPtr subscriptionTo(const std::string& topic) {
  for (const auto& subscription : allSubscriptions()) {
    if (subscription->getName() == topic && !subscription->isDropped()) {
      return subscription;
    }
  }
  return nullptr;
}

}  // namespace

// ---- what the others need to know ------------------------------------------------------------

void readExcludedTopics() {
  std::vector<std::string> names;
  ros::param::get("/time_master/excluded_topics", names);
  for (const std::string& name : names) {
    excludedTopics().insert(ros::names::resolve(name));
  }
}

bool isManaged(const std::string& topic) {
  return takesPart() && excludedTopics().count(topic) == 0;
}

void dropConnectionsTo(const std::string& node_name) {
  for (const auto& subscription : allSubscriptions()) {
    std::vector<ros::PublisherLinkPtr> links;
    {
      const boost::mutex::scoped_lock lock((*subscription).*open(OfPublisherLinksMutex()));
      links = (*subscription).*open(OfPublisherLinks());
    }
    for (const auto& link : links) {
      if (isManaged(subscription->getName()) && link->getCallerID() == node_name) {
        link->drop();
      }
    }
  }
  for (const auto& publication :
       ros::V_Publication((*ros::TopicManager::instance()).*open(OfPublications()))) {
    ros::V_SubscriberLink links;
    {
      const boost::mutex::scoped_lock lock((*publication).*open(OfSubscriberLinksMutex()));
      links = (*publication).*open(OfSubscriberLinks());
    }
    for (const auto& link : links) {
      if (isManaged(publication->getName()) && link->getDestinationCallerID() == node_name) {
        publication->removeSubscriberLink(link);
        const std::lock_guard<PlainMutex> lock(topics().silent_mutex);
        topics().silent.push_back(link);
      }
    }
  }
}

// ---- what the time master tells --------------------------------------------------------------

void handle(const wire::Subscriber& item) {
  Topic* const topic = topics().of(item.topic);
  const auto publication =
      topic == nullptr ? nullptr : ros::TopicManager::instance()->lookupPublication(topic->name);
  if (publication && topic->receivers.count(item.receiver) == 0) {
    const auto link = boost::make_shared<MemberSubscriber>(*topic, item.receiver);
    topic->receivers[item.receiver] = link;
    publication->addSubscriberLink(link);
  }
}

void handle(const wire::NoSubscriber& item) {
  Topic* const topic = topics().of(item.topic);
  const auto publication =
      topic == nullptr ? nullptr : ros::TopicManager::instance()->lookupPublication(topic->name);
  if (publication && topic->receivers.count(item.receiver) > 0) {
    publication->removeSubscriberLink(topic->receivers.at(item.receiver));
    topic->receivers.erase(item.receiver);
  }
}

void handle(const wire::Publisher& item) {
  Topic* const topic = topics().of(item.topic);
  const auto subscription = topic == nullptr ? nullptr : subscriptionTo(topic->name);
  if (!subscription || topic->senders.count(item.sender) > 0) {
    return;
  }
  const ros::M_string values{{"callerid", node().nameOf(item.sender)},
                             {"topic", topic->name},
                             {"type", std::string(item.type)},
                             {"md5sum", std::string(item.md5)},
                             {"message_definition", std::string(item.definition)},
                             {"latching", item.latched ? "1" : "0"}};
  boost::shared_array<std::uint8_t> bytes;
  std::uint32_t size = 0;
  ros::Header::write(values, bytes, size);
  ros::Header header;
  std::string error;
  header.parse(bytes.get(), size, error);
  const auto link = boost::make_shared<MemberPublisher>(subscription, item.sender);
  link->setHeader(header);
  topic->senders[item.sender] = link;
  ((*subscription).*open(OfAddPublisherLink()))(link);
}

void handle(const wire::NoPublisher& item) {
  Topic* const topic = topics().of(item.topic);
  const auto subscription = topic == nullptr ? nullptr : subscriptionTo(topic->name);
  if (topic != nullptr && topic->senders.count(item.sender) > 0) {
    if (subscription) {
      subscription->removePublisherLink(topic->senders.at(item.sender));
    }
    topic->senders.erase(item.sender);
  }
}

void handle(const wire::Deliver& item) {
  Topic* const topic = topics().of(item.topic);
  const auto subscription = topic == nullptr ? nullptr : subscriptionTo(topic->name);
  if (!subscription || topic->senders.count(item.sender) == 0) {
    return;  // unsubscribed when it was under way
  }
  const auto& link = topic->senders.at(item.sender);
  const boost::shared_array<std::uint8_t> bytes(new std::uint8_t[item.payload.size() + 1]);
  std::memcpy(bytes.get(), item.payload.data(), item.payload.size());
  link->count(item.payload.size());
  handleMessage()(subscription.get(), ros::SerializedMessage(bytes, item.payload.size()), true,
                  false, link->values(), link);
}

}  // namespace move_base_abstract::shim

// ---- in front of roscpp ----------------------------------------------------------------------

namespace shim = move_base_abstract::shim;
namespace wire = move_base_abstract::wire;

namespace ros {

bool TopicManager::advertise(const AdvertiseOptions& options,
                             const SubscriberCallbacksPtr& callbacks) {
  using Advertise = bool(TopicManager*, const AdvertiseOptions&, const SubscriberCallbacksPtr&);
  static Advertise* const function = shim::real<Advertise>(
      "_ZN3ros12TopicManager9advertiseERKNS_16AdvertiseOptionsERKN5boost10shared_ptrINS_"
      "19SubscriberCallbacksEEE");
  const bool is_app = shim::turn().enter() && shim::isManaged(options.topic);
  const shim::Inside inside;
  const bool is_done = function(this, options, callbacks);
  if (is_app && is_done) {
    shim::Topic& topic = shim::topics().of(options.topic);
    if (!topic.is_advertised) {
      topic.is_advertised = true;
      shim::node().append(wire::Advertise{topic.number, 0, topic.name, options.datatype,
                                          options.md5sum, options.latch,
                                          options.message_definition});
    }
  }
  return is_done;
}

bool TopicManager::unadvertise(const std::string& name, const SubscriberCallbacksPtr& callbacks) {
  using Unadvertise = bool(TopicManager*, const std::string&, const SubscriberCallbacksPtr&);
  static Unadvertise* const function = shim::real<Unadvertise>(
      "_ZN3ros12TopicManager11unadvertiseERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKN"
      "5boost10shared_ptrINS_19SubscriberCallbacksEEE");
  const bool is_app = shim::turn().enter() && shim::isManaged(name);
  const bool is_done = function(this, name, callbacks);
  if (is_app && !lookupPublication(name)) {
    shim::Topic& topic = shim::topics().of(name);
    topic.receivers.clear();
    if (topic.is_advertised) {
      topic.is_advertised = false;
      shim::node().append(wire::Unadvertise{topic.number});
    }
  }
  return is_done;
}

void TopicManager::publish(const std::string& name,
                           const boost::function<SerializedMessage(void)>& serialize,
                           SerializedMessage& message) {
  using Publish = void(TopicManager*, const std::string&,
                       const boost::function<SerializedMessage(void)>&, SerializedMessage&);
  static Publish* const function = shim::real<Publish>(
      "_ZN3ros12TopicManager7publishERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKN5"
      "boost8functionIFNS_17SerializedMessageEvEEERSB_");
  const bool is_app = shim::turn().enter() && shim::isManaged(name);
  function(this, name, serialize, message);
  if (!is_app) {
    return;
  }
  shim::Turn::self()->has_acted = true;
  // Now, not in roscpp's thread: it is a part of this round.
  const shim::Inside inside;
  const PublicationPtr publication = lookupPublication(name);
  if (publication) {
    shim::topics().broadcast = publication->isLatched() ? nullptr : &shim::topics().of(name);
    shim::topics().is_sent = false;
    publication->processPublishQueue();
    shim::topics().broadcast = nullptr;
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
  using Subscribe = bool(TopicManager*, const SubscribeOptions&);
  static Subscribe* const function =
      shim::real<Subscribe>("_ZN3ros12TopicManager9subscribeERKNS_16SubscribeOptionsE");
  if (shim::isStarting() && options.topic == names::resolve("/clock")) {
    return true;  // roscpp's own: grants say what time it is, and a message may be ahead of them
  }
  const bool is_app = shim::turn().enter() && shim::isManaged(options.topic);
  const shim::Inside inside;
  const bool is_done = function(this, options);
  if (is_app && is_done) {
    shim::Topic& topic = shim::topics().of(options.topic);
    if (!topic.is_subscribed) {
      topic.is_subscribed = true;
      shim::node().append(wire::Subscribe{topic.number, 0, topic.name, options.md5sum});
    }
  }
  return is_done;
}

bool TopicManager::unsubscribe(const std::string& name,
                               const SubscriptionCallbackHelperPtr& helper) {
  using Unsubscribe = bool(TopicManager*, const std::string&, const SubscriptionCallbackHelperPtr&);
  static Unsubscribe* const function = shim::real<Unsubscribe>(
      "_ZN3ros12TopicManager11unsubscribeERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKN"
      "5boost10shared_ptrINS_26SubscriptionCallbackHelperEEE");
  const bool is_app = shim::turn().enter() && shim::isManaged(name);
  const bool is_done = function(this, name, helper);
  if (is_app && !shim::subscriptionTo(name)) {
    shim::Topic& topic = shim::topics().of(name);
    topic.senders.clear();
    if (topic.is_subscribed) {
      topic.is_subscribed = false;
      shim::node().append(wire::Unsubscribe{topic.number});
    }
  }
  return is_done;
}

size_t TopicManager::getNumSubscribers(const std::string& name) {
  using GetNumber = size_t(TopicManager*, const std::string&);
  static GetNumber* const function = shim::real<GetNumber>(
      "_ZN3ros12TopicManager17getNumSubscribersERKNSt7__cxx1112basic_stringIcSt11char_"
      "traitsIcESaIcEEE");
  const size_t number = function(this, name);
  if (shim::turn().enter() && shim::isManaged(name) &&
      number > shim::topics().of(name).receivers.size()) {
    shim::node().label("it was asked how many listen to " + name +
                       ", among whom are nodes that do not take part");
  }
  return number;
}

uint32_t Subscription::handleMessage(const SerializedMessage& message, bool serialized, bool nocopy,
                                     const boost::shared_ptr<M_string>& header,
                                     const PublisherLinkPtr& link) {
  if (!shim::takesPart() || nocopy) {
    return shim::handleMessage()(this, message, serialized, nocopy, header, link);
  }
  const bool is_managed = shim::isManaged(name_);
  if (is_managed && shim::node().isMember(link->getCallerID())) {
    return 0;  // it comes with a grant; this is the copy for those that do not take part
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
  using AddLocal = void(Subscription*, const PublicationPtr&);
  static AddLocal* const function = shim::real<AddLocal>(
      "_ZN3ros12Subscription18addLocalConnectionERKN5boost10shared_ptrINS_11PublicationEEE");
  if (!shim::isManaged(name_)) {
    function(this, publication);
  }
}

bool Subscription::negotiateConnection(const std::string& uri) {
  using Negotiate = bool(Subscription*, const std::string&);
  static Negotiate* const function = shim::real<Negotiate>(
      "_ZN3ros12Subscription19negotiateConnectionERKNSt7__cxx1112basic_stringIcSt11char_"
      "traitsIcESaIcEEE");
  return (shim::isManaged(name_) && shim::node().isMemberAt(uri)) || function(this, uri);
}

void Publication::addSubscriberLink(const SubscriberLinkPtr& link) {
  using Add = void(Publication*, const SubscriberLinkPtr&);
  static Add* const function = shim::real<Add>(
      "_ZN3ros11Publication17addSubscriberLinkERKN5boost10shared_ptrINS_14SubscriberLinkEEE");
  const bool is_ours = dynamic_cast<shim::MemberSubscriber*>(link.get()) != nullptr;
  if (!is_ours && shim::isManaged(name_) && shim::node().isMember(link->getDestinationCallerID())) {
    const std::lock_guard<shim::PlainMutex> lock(shim::topics().silent_mutex);
    shim::topics().silent.push_back(link);
  } else {
    function(this, link);
  }
}

void Publication::removeSubscriberLink(const SubscriberLinkPtr& link) {
  using Remove = void(Publication*, const SubscriberLinkPtr&);
  static Remove* const function = shim::real<Remove>(
      "_ZN3ros11Publication20removeSubscriberLinkERKN5boost10shared_ptrINS_14SubscriberLinkEEE");
  function(this, link);
  const std::lock_guard<shim::PlainMutex> lock(shim::topics().silent_mutex);
  auto& silent = shim::topics().silent;
  silent.erase(std::remove(silent.begin(), silent.end(), link), silent.end());
}

}  // namespace ros
