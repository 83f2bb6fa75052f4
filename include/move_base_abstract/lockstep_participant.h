// The classes by which a roscpp node takes part in lockstep, the event-driven clock.
// docs/lockstep_cpp.md is the contract. Use them from one thread only: the one that constructs the
// Participant.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_PARTICIPANT_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_PARTICIPANT_H

#include <ros/advertise_options.h>
#include <ros/advertise_service_options.h>
#include <ros/callback_queue_interface.h>
#include <ros/forwards.h>
#include <ros/serialization.h>
#include <ros/subscribe_options.h>
#include <ros/time.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace move_base_abstract::lockstep {

/**
 * @brief A call that a participant cannot fulfil. The text names the node and the call, and says
 * what is allowed.
 */
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/** @brief The time master runs, but not in lockstep. */
class NotLockstep : public Error {
 public:
  using Error::Error;
};

namespace internal {
class Core;
class Publication;
class Subscription;
class Service;
class TimerState;
}  // namespace internal

/** @brief Publishes on a topic as long as a copy of this object exists, like ros::Publisher. */
class Publisher {
 public:
  Publisher() = default;

  /**
   * @brief Publish @p message. Participants get it after this node's report, in the stated order;
   * other nodes get it at once.
   * @throws Error if this Publisher is empty or has outlived its Participant, or if @p M is not the
   * type that was advertised.
   */
  template <class M>
  void publish(const M& message) const {
    publishBytes(ros::serialization::serializeMessage(message),
                 ros::message_traits::md5sum(message));
  }

  /**
   * @brief The number of participants that listen to the topic, as of this instant; for a topic
   * that does not go through the time master, the number of connected nodes.
   */
  std::uint32_t getNumSubscribers() const;
  std::string getTopic() const;
  explicit operator bool() const { return static_cast<bool>(publication_); }

 private:
  friend class Participant;
  explicit Publisher(std::shared_ptr<internal::Publication> publication)
      : publication_(std::move(publication)) {}
  void publishBytes(const ros::SerializedMessage& message, const std::string& md5) const;

  std::shared_ptr<internal::Publication> publication_;
};

/** @brief Listens to a topic as long as a copy of this object exists, like ros::Subscriber. */
class Subscriber {
 public:
  Subscriber() = default;
  std::string getTopic() const;
  /** @brief The number of participants that publish on the topic, as of this instant. */
  std::uint32_t getNumPublishers() const;
  explicit operator bool() const { return static_cast<bool>(subscription_); }

 private:
  friend class Participant;
  explicit Subscriber(std::shared_ptr<internal::Subscription> subscription)
      : subscription_(std::move(subscription)) {}

  std::shared_ptr<internal::Subscription> subscription_;
};

/** @brief Offers a service as long as a copy of this object exists, like ros::ServiceServer. */
class ServiceServer {
 public:
  ServiceServer() = default;
  explicit operator bool() const { return static_cast<bool>(service_); }

 private:
  friend class Participant;
  explicit ServiceServer(std::shared_ptr<internal::Service> service)
      : service_(std::move(service)) {}

  std::shared_ptr<internal::Service> service_;
};

/** @brief Calls its callback as long as a copy of this object exists, like ros::Timer. */
class Timer {
 public:
  Timer() = default;
  void stop();
  /** @brief Let the timer fire one period from now; this has no effect on a timer that runs. */
  void start();
  bool isRunning() const;
  explicit operator bool() const { return static_cast<bool>(state_); }

 private:
  friend class Participant;
  explicit Timer(std::shared_ptr<internal::TimerState> state) : state_(std::move(state)) {}

  std::shared_ptr<internal::TimerState> state_;
};

struct Options {
  /**
   * The node's place among the participants that act at one instant, smallest first. Without it the
   * node's parameter ~lockstep_rank counts; without both, the node comes after the robots, which
   * have 0. Nodes of one rank come in the order of their names (node_2 before node_10).
   */
  std::optional<std::int32_t> rank;
};

/**
 * @brief The part of one roscpp node in lockstep. A process has at most one.
 *
 * Functions that act throw Error if another thread calls them, or after leave(). spin(), spinOnce()
 * and spinUntil() also throw it in a callback.
 */
class Participant {
 public:
  /**
   * @brief Join the run, and return at the node's first instant. From then on the node has its turn
   * until it sleeps or spins. Call this after ros::init. It waits for the time master, and for the
   * other participants that the run needs.
   *
   * @throws NotLockstep if the time master runs but is not in lockstep.
   * @throws Error if ros::init was not called, if the process has a Participant already, if a
   * parameter is wrong, if the time master refuses this node, or if ROS shuts down meanwhile.
   */
  explicit Participant(const Options& options = Options());
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /**
   * @brief Publish on @p topic.
   * @param outside_queue_size the number of messages that are kept for each slow node that does not
   * take part.
   * @throws Error if this node publishes on the topic with another type already.
   */
  template <class M>
  Publisher advertise(const std::string& topic, bool latch = false,
                      std::uint32_t outside_queue_size = 1000) {
    ros::AdvertiseOptions options;
    options.init<M>(topic, outside_queue_size);
    options.latch = latch;
    return advertise(options);
  }

  /**
   * @brief Listen to @p topic.
   * @param callback takes const M&, M::ConstPtr or const ros::MessageEvent<M const>&.
   * @param queue_size the number of messages that are kept at one instant, the newest ones; 0: all.
   * @throws Error if this node listens to the topic with another type already.
   */
  template <class M, class Callback>
  Subscriber subscribe(const std::string& topic, Callback callback, std::uint32_t queue_size = 0) {
    ros::SubscribeOptions options;
    using Pointer = boost::shared_ptr<const M>;
    using Event = ros::MessageEvent<const M>;
    if constexpr (std::is_invocable_v<Callback&, const M&>) {
      options.initByFullCallbackType<const M&>(topic, queue_size, callback);
    } else if constexpr (std::is_invocable_v<Callback&, const Pointer&>) {
      options.initByFullCallbackType<const Pointer&>(topic, queue_size, callback);
    } else {
      static_assert(std::is_invocable_v<Callback&, const Event&>,
                    "a callback takes const M&, M::ConstPtr or const ros::MessageEvent<M const>&");
      options.initByFullCallbackType<const Event&>(topic, queue_size, callback);
    }
    return subscribe(options);
  }

  Publisher advertise(const ros::AdvertiseOptions& options);
  Subscriber subscribe(const ros::SubscribeOptions& options);

  /**
   * @brief Answer the calls of a service, from participants and from outside.
   * @param callback bool(S::Request&, S::Response&)
   * @throws Error if this node offers the service already.
   */
  template <class S, class Callback>
  ServiceServer advertiseService(const std::string& service, Callback callback) {
    using Function = boost::function<bool(typename S::Request&, typename S::Response&)>;
    ros::AdvertiseServiceOptions options;
    options.init<typename S::Request, typename S::Response>(service, Function(callback));
    return advertiseService(options);
  }

  ServiceServer advertiseService(const ros::AdvertiseServiceOptions& options);

  /**
   * @brief Call a service that a participant offers. Simulated time may pass meanwhile.
   * @return whether the call succeeded, like ros::ServiceClient::call; if not, the log says why.
   */
  template <class S>
  bool call(const std::string& service, S& call) {
    const auto response = callBytes(service, ros::serialization::serializeMessage(call.request));
    if (!response) {
      return false;
    }
    ros::serialization::IStream stream(
        reinterpret_cast<std::uint8_t*>(const_cast<char*>(response->data())),
        static_cast<std::uint32_t>(response->size()));
    ros::serialization::deserialize(stream, call.response);
    return true;
  }

  /**
   * @brief Wait until a participant offers the service. @return whether a participant offers it.
   */
  bool waitForService(const std::string& service,
                      const std::optional<ros::Duration>& timeout = std::nullopt);

  /** @brief The simulated time of the present grant. ros::Time::now() gives the same. */
  ros::Time now() const;
  /** @brief The number of the present round at this instant, from 0 on. */
  std::uint32_t microstep() const;

  /**
   * @brief Sleep for @p duration of simulated time. Callbacks run meanwhile, unless this is called
   * from a callback.
   * @return false if the run or the node ends before.
   */
  bool sleep(const ros::Duration& duration);
  bool sleepUntil(const ros::Time& time);

  /** @brief Run callbacks until ROS shuts down, the run ends, or a callback calls leave(). */
  void spin();

  /**
   * @brief Give way once, without letting time pass, and handle what others have sent at this
   * instant.
   * @return false if the run or the node has ended.
   */
  bool spinOnce();

  /**
   * @brief Run callbacks until @p done() is true; it is called after each grant. Without a timeout
   * this counts as open work: if nothing is left to happen, the time master reports a deadlock.
   * @param what names what the node waits for, in the messages of the time master.
   * @return whether done() became true.
   */
  bool spinUntil(const std::function<bool()>& done,
                 const std::optional<ros::Duration>& timeout = std::nullopt,
                 const std::string& what = "a condition");

  /**
   * @brief Make a timer that calls @p callback every @p period of simulated time, on an exact grid.
   * @throws Error unless the period is more than 0; that of a oneshot timer may be 0.
   */
  Timer createTimer(const ros::Duration& period,
                    std::function<void(const ros::TimerEvent&)> callback, bool oneshot = false,
                    bool autostart = true);

  /**
   * @brief Write a line into the run's event log.
   * @param values a JSON array, without spaces.
   * @param sub the index of the robot in this node's fleet, by which the lines of one instant are
   * ordered.
   */
  void log(const std::string& robot, const std::string& kind, const std::string& values,
           std::uint32_t sub = 0);

  /**
   * @brief Set a ROS parameter. It changes when the round is over; all nodes that read it
   * afterwards, this one included, get the value that the rounds have given it.
   * @throws ros::InvalidNameException if @p key is not a valid name.
   * @throws Error if XML-RPC cannot express the value: it has no type, or a text in it is
   * not UTF-8 or has control characters.
   */
  void setParam(const std::string& key, const XmlRpc::XmlRpcValue& value);
  /**
   * @brief Delete a ROS parameter when the round is over. This has no effect on a parameter that
   * does not exist.
   */
  void deleteParam(const std::string& key);
  /**
   * @brief Say that this node depends on the parameter @p key. The run gets a label if a node that
   * does not take part sets or deletes it, or a parameter above or below it.
   */
  void asksForParam(const std::string& key);

  /** @brief Give the run a label: @p reason says why it cannot be repeated exactly. */
  void label(const std::string& reason);

  /**
   * @brief Declare that the messages on @p topic from outside are the same in every run, such as a
   * map. Then they give the run no label.
   */
  void constant(const std::string& topic);

  /**
   * @brief The callback queue for ordinary roscpp parts of this node:
   * nodehandle.setCallbackQueue(outsideQueue()). Their callbacks run as input from outside. The
   * parts must not outlive the participant.
   */
  ros::CallbackQueueInterface* outsideQueue();

  std::int32_t rank() const;

  /**
   * @brief End this node's part in the run with a last report. The messages that it has published
   * still go out. @param reason is logged, if it is not empty.
   */
  void leave(const std::string& reason = "");

  /** @return whether the node still takes part. */
  bool active() const;

 private:
  std::optional<std::string> callBytes(const std::string& service,
                                       const ros::SerializedMessage& request);

  std::shared_ptr<internal::Core> core_;
};

/** @brief The counterpart of ros::Rate in a participant. */
class Rate {
 public:
  /** @param frequency [Hz, simulated]. @throws Error unless the cycle is more than 0 s. */
  Rate(Participant& participant, double frequency);
  Rate(Participant& participant, const ros::Duration& cycle);

  /**
   * @brief Sleep until the end of the cycle. @return false if the cycle is over already, or if the
   * run or the node ends before.
   */
  bool sleep();
  void reset();
  ros::Duration expectedCycleTime() const { return cycle_; }

 private:
  Participant& participant_;
  ros::Duration cycle_;
  ros::Time start_;
};

}  // namespace move_base_abstract::lockstep

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_PARTICIPANT_H
