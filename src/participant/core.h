// What a participant is behind its public face: rounds, mail, timers and topics, in one thread.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_CORE_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_CORE_H

#include <ros/node_handle.h>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "link.h"
#include "lockstep/wire.h"
#include "move_base_abstract/lockstep_participant.h"
#include "outside.h"

namespace move_base_abstract::lockstep::internal {

using HeaderPtr = boost::shared_ptr<ros::M_string>;

/** @brief A member that publishes on a topic of ours, as its PUBLISHER item presented it. */
struct Sender {
  std::string md5;
  bool latched = false;
  HeaderPtr header;                 // what roscpp would have as the connection header
  std::optional<std::string> last;  // of a latched topic
};

/** @brief A topic name on which this node publishes, listens, or both. */
struct Topic {
  std::uint32_t number = 0;
  std::string name;
  int publications = 0;  // handles alive
  bool latched = false;
  bool has_header = false;
  bool excluded = false;  // by the time master: roscpp alone carries it, uncounted
  bool constant = false;  // what comes from outside is the same in every run
  std::uint32_t sequence = 0;
  std::string md5;                             // of what is published
  std::optional<std::string> last;             // latched
  std::set<std::uint32_t> receivers;           // members, by id
  std::multiset<std::string> connected;        // nodes that roscpp has connected, members included
  ros::Publisher outside;                      // roscpp's publisher, while publications > 0
  std::vector<Subscription*> subscriptions;    // alive, in the order of their creation
  std::map<std::uint32_t, Sender> publishers;  // members, by id
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
  Topic* topic_;  // good while the core lives
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
  bool takes(const std::string& md5) const {
    return options_.md5sum == "*" || options_.md5sum == md5;
  }

  /** @brief One more message waits in the mail. */
  void expect() { ++waiting_; }
  /** @return whether its turn has come to be handled: the queue size keeps the newest. */
  bool isWanted();
  /** @brief Hand over one message: of a member (bytes), or from outside (a message already). */
  void handle(const HeaderPtr& header, const std::string& payload);
  void handle(const ros::MessageEvent<void const>& event);

  /** @brief Have roscpp deliver what comes from outside through @p queue. */
  void listenOutside(ros::NodeHandle& node, const std::shared_ptr<OutsideQueue>& queue,
                     const std::string& unresolved, Interceptor::Handler handler);

 private:
  std::weak_ptr<Core> core_;
  Topic* topic_;
  ros::SubscribeOptions options_;
  std::size_t waiting_ = 0;
  std::shared_ptr<OutsideQueue> queue_;  // roscpp holds a plain pointer to it
  ros::Subscriber outside_;
};

class Service {
 public:
  Service(const std::shared_ptr<Core>& core, std::uint32_t number, std::string name,
          ros::ServiceCallbackHelperPtr helper)
      : core_(core), number_(number), name_(std::move(name)), helper_(std::move(helper)) {}
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /** @return the item that answers the call. */
  void answer(std::uint32_t caller, std::uint32_t number, const std::string& caller_name,
              std::string_view request);
  void listenOutside(ros::NodeHandle& node, const std::shared_ptr<OutsideQueue>& queue,
                     ros::AdvertiseServiceOptions options);

 private:
  std::weak_ptr<Core> core_;
  std::uint32_t number_;
  std::string name_;
  ros::ServiceCallbackHelperPtr helper_;
  std::shared_ptr<OutsideQueue> queue_;
  ros::ServiceServer outside_;
};

class TimerState : public std::enable_shared_from_this<TimerState> {
 public:
  using Callback = std::function<void(const ros::TimerEvent&)>;

  TimerState(const std::shared_ptr<Core>& core, Nanoseconds period, Callback callback,
             bool oneshot);
  ~TimerState();
  TimerState(const TimerState&) = delete;
  TimerState& operator=(const TimerState&) = delete;

  void start();
  void stop();
  bool isRunning() const { return is_running_; }
  void fire();

 private:
  friend class Core;
  std::weak_ptr<Core> core_;
  std::uint64_t number_;  // order of creation
  Nanoseconds period_;
  Nanoseconds due_ = kNever;
  Nanoseconds last_due_ = 0;
  Nanoseconds last_fired_ = 0;
  bool oneshot_;
  bool is_running_ = false;
  Callback callback_;
};

/** @brief The participant's state; it has its turn except inside wait(). */
class Core : public std::enable_shared_from_this<Core> {
 public:
  enum class Woken { kDone, kTime, kOver };
  enum class Callbacks { kRun, kWait };

  explicit Core(const Options& options);
  ~Core();

  /** @brief Connect, present the node, and wait for its first grant. @throws Error, NotLockstep */
  void join();
  void leave(const std::string& reason);
  bool isActive() const { return state_ == State::kTurn || state_ == State::kReported; }

  /**
   * @brief Give the turn away until @p done() is true or simulated time has come to @p until.
   * Callbacks run meanwhile, or wait until after (as they do inside a callback anyway).
   * @param what a wait for something without end is shown as a wait for this.
   */
  Woken wait(Nanoseconds until, Callbacks callbacks, const std::function<bool()>& done = nullptr,
             const std::string& what = "");
  bool giveWay();

  /** @throws Error if the caller is another thread, or the participant has left. */
  void check(const char* what) const;
  void checkOutsideCallback(const char* what) const;

  std::shared_ptr<Publication> advertise(const ros::AdvertiseOptions& options);
  void publish(Topic& topic, const ros::SerializedMessage& message, const std::string& md5);
  void unadvertise(Topic& topic);
  std::uint32_t subscribers(Topic& topic);
  std::shared_ptr<Subscription> subscribe(const ros::SubscribeOptions& options);
  void unsubscribe(Subscription& subscription);
  std::shared_ptr<Service> serve(const ros::AdvertiseServiceOptions& options);
  void unserve(std::uint32_t service);
  std::optional<std::string> call(const std::string& service,
                                  const ros::SerializedMessage& request);
  bool waitForService(const std::string& service, Nanoseconds until);

  void append(const wire::ReportItem& item);
  void label(const std::string& reason);
  void makeConstant(const std::string& topic);
  void schedule(TimerState& timer);
  void unschedule(TimerState& timer);
  std::uint64_t nextTimerNumber() { return ++timers_made_; }

  Nanoseconds now() const { return now_; }
  std::uint32_t microstep() const { return microstep_; }
  std::int32_t rank() const { return rank_; }
  OutsideQueue& userQueue() { return *user_queue_; }
  const std::string& name() const { return name_; }

 private:
  /** kReported: waits for a grant. kLeft: by itself. kOver: the time master or ROS has ended. */
  enum class State { kJoining, kTurn, kReported, kLeft, kOver };

  void connectToTimeMaster();
  void readParameters(const Options& options);
  void sayHello();
  void report(Nanoseconds next, bool leaving);
  void awaitGrant();
  void readFrames();
  void handle(const wire::Welcome& frame);
  void handle(const wire::Member& frame);
  void handle(const wire::Gone& frame);
  void handle(const wire::Grant& frame);
  void handle(const wire::End& frame);
  void handle(const wire::Publisher& item);
  void handle(const wire::NoPublisher& item);
  void handle(const wire::Subscriber& item);
  void handle(const wire::NoSubscriber& item);
  void handle(const wire::Deliver& item);
  void handle(const wire::CallIn& item);
  void handle(const wire::Answer& item);
  void handle(const wire::Found& item);

  void takeOutside();
  void knockIfNeeded();
  void enterOutside();
  void runCallbacks();
  void runOne(const std::function<void()>& callback);
  TimerState* dueTimer() const;
  Nanoseconds nextDue(Nanoseconds until, Callbacks callbacks) const;
  void end(const std::string& reason);
  void endIfRosHas();

  Topic& topicOf(const std::string& name);
  Topic* topicOf(std::uint32_t number);
  void deliver(const std::shared_ptr<Subscription>& subscription, const HeaderPtr& header,
               const std::string& payload);
  void fromOutside(const std::weak_ptr<Subscription>& subscription,
                   const ros::MessageEvent<void const>& event);
  void connectionChanged(std::uint32_t topic, const std::string& node, bool connected);
  bool isMember(const std::string& node) const;
  bool hasOutsiders(const Topic& topic) const;
  ros::NodeHandle& nodeFor(const std::string& name, std::string* rest);

  const std::thread::id thread_ = std::this_thread::get_id();
  std::string name_;
  std::int32_t rank_ = 1000;  // robots have 0
  bool rank_declared_ = false;
  ros::NodeHandle node_;
  ros::NodeHandle private_node_{"~"};

  Link link_;
  wire::FrameBuffer frames_;
  std::string items_;  // of the next report
  std::string received_;
  std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
  std::shared_ptr<OutsideQueue> own_queue_ = std::make_shared<OutsideQueue>(bell_);
  std::shared_ptr<OutsideQueue> user_queue_ = std::make_shared<OutsideQueue>(bell_);

  State state_ = State::kJoining;
  std::string end_reason_;
  std::uint64_t round_ = 0;
  Nanoseconds now_ = 0;
  std::uint32_t microstep_ = 0;
  std::string waits_for_;  // a wait without end that is open work; else empty
  std::string told_;       // of it, to the time master
  bool has_knocked_ = false;
  bool is_in_callback_ = false;

  std::map<std::uint32_t, std::string> members_;
  std::multiset<std::string> member_names_;  // of the others
  std::map<std::uint32_t, Topic> topics_;
  std::map<std::string, std::uint32_t> topic_numbers_;
  std::map<std::uint32_t, std::weak_ptr<Service>> services_;
  std::uint32_t services_made_ = 0;
  std::uint32_t calls_made_ = 0;
  std::map<std::uint32_t, std::pair<wire::CallStatus, std::string>> answers_;
  std::set<std::string> found_;
  std::deque<std::function<void()>> mail_;
  std::deque<std::function<void()>> outside_;  // to enter with the next grant
  std::set<std::string> labels_;
  std::set<std::string> excluded_;
  std::map<std::pair<Nanoseconds, std::uint64_t>, TimerState*> timers_;  // by (due, creation)
  std::uint64_t timers_made_ = 0;
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_CORE_H
