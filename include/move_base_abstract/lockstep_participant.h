// How a roscpp node takes part in lockstep, the event-driven clock. docs/lockstep_cpp.md is the
// contract. Everything here is for one thread: the one that constructs the Participant.
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

/** @brief What a participant cannot do; the text says who asked for what, and what is allowed. */
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

/** @brief Publishes on a topic while a copy of it lives, like ros::Publisher. */
class Publisher {
 public:
  Publisher() = default;

  /** @brief To participants with the report, in order; to other nodes at once. */
  template <class M>
  void publish(const M& message) const {
    publishBytes(ros::serialization::serializeMessage(message),
                 ros::message_traits::md5sum(message));
  }

  /** @brief Participants that listen, as of this instant; nodes that do not take
   * part. */
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

/** @brief Listens to a topic while a copy of it lives, like ros::Subscriber. */
class Subscriber {
 public:
  Subscriber() = default;
  std::string getTopic() const;
  /** @brief Participants that publish on the topic, as of this instant. */
  std::uint32_t getNumPublishers() const;
  explicit operator bool() const { return static_cast<bool>(subscription_); }

 private:
  friend class Participant;
  explicit Subscriber(std::shared_ptr<internal::Subscription> subscription)
      : subscription_(std::move(subscription)) {}

  std::shared_ptr<internal::Subscription> subscription_;
};

/** @brief Offers a service while a copy of it lives, like ros::ServiceServer. */
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

/** @brief Fires while a copy of it lives, like ros::Timer. */
class Timer {
 public:
  Timer() = default;
  void stop();
  /** @brief Due one period from now; no effect on a timer that runs. */
  void start();
  bool isRunning() const;
  explicit operator bool() const { return static_cast<bool>(state_); }

 private:
  friend class Participant;
  explicit Timer(std::shared_ptr<internal::TimerState> state) : state_(std::move(state)) {}

  std::shared_ptr<internal::TimerState> state_;
};

struct Options {
  /** Order among those who act at one instant, smallest first; else ~lockstep_rank, else by name.
   */
  std::optional<std::int32_t> rank;
};

/** @brief One roscpp node's part in lockstep; one per process. */
class Participant {
 public:
  /**
   * @brief Join, and return at the node's first instant; from then on it has its turn until it
   * sleeps or spins. Call it after ros::init. It waits for the time master and for the others that
   * the run needs.
   *
   * @throws NotLockstep if the time master runs but is not in lockstep.
   * @throws Error if it refuses this node, or ROS shuts down meanwhile.
   */
  explicit Participant(const Options& options = Options());
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /** @param outside_queue_size messages kept for each slow node that does not take part. */
  template <class M>
  Publisher advertise(const std::string& topic, bool latch = false,
                      std::uint32_t outside_queue_size = 1000) {
    ros::AdvertiseOptions options;
    options.init<M>(topic, outside_queue_size);
    options.latch = latch;
    return advertise(options);
  }

  /**
   * @param callback takes const M&, M::ConstPtr or const ros::MessageEvent<M const>&.
   * @param queue_size messages kept at one instant, the newest; 0 = all.
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
   * @brief Answer a service's calls, from participants and from outside.
   * @param callback bool(S::Request&, S::Response&)
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
   * @brief Call a service that a participant offers; simulated time may pass meanwhile.
   * @return whether the answer is good, like ros::ServiceClient::call; if not, the log says why.
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

  /** @brief Wait until a participant offers the service. @return whether one does. */
  bool waitForService(const std::string& service,
                      const std::optional<ros::Duration>& timeout = std::nullopt);

  /** @brief Simulated time: that of the grant under way. ros::Time::now() says the same. */
  ros::Time now() const;
  std::uint32_t microstep() const;

  /**
   * @brief Let others go on for @p duration; callbacks run meanwhile (but inside a callback none).
   * @return false if the run or the node ends before.
   */
  bool sleep(const ros::Duration& duration);
  bool sleepUntil(const ros::Time& time);

  /** @brief Run callbacks until ROS shuts down, the time master goes, or a callback leaves. */
  void spin();

  /**
   * @brief Give way once without letting time pass: what others have sent at this instant is
   * handled. @return false if the run or the node has ended.
   */
  bool spinOnce();

  /**
   * @brief Run callbacks until @p done() is true, looked at after each grant. Without a timeout
   * this counts as open work: if nothing is left to happen, the time master names it as a deadlock.
   * @param what is shown as what the node waits for. @return what done() says.
   */
  bool spinUntil(const std::function<bool()>& done,
                 const std::optional<ros::Duration>& timeout = std::nullopt,
                 const std::string& what = "a condition");

  /** @brief Call @p callback every @p period (> 0; a oneshot timer's may be 0), on an exact grid.
   */
  Timer createTimer(const ros::Duration& period,
                    std::function<void(const ros::TimerEvent&)> callback, bool oneshot = false,
                    bool autostart = true);

  /**
   * @brief Write a line into the run's event log. @param values a JSON array, compact.
   * @param sub index of the robot in this node's fleet, which orders the lines of one instant.
   */
  void log(const std::string& robot, const std::string& kind, const std::string& values,
           std::uint32_t sub = 0);

  /**
   * @brief Set a parameter of ROS when the round is over; who gets it then, this node too, gets
   * what the rounds have made of it. @throws ros::InvalidNameException
   * @throws Error for what XML-RPC cannot say: a value without a type, texts that are no UTF-8
   */
  void setParam(const std::string& key, const XmlRpc::XmlRpcValue& value);
  /** @brief The same for a deletion; of what is not there it has no effect. */
  void deleteParam(const std::string& key);
  /** @brief Whoever takes no part and sets @p key, or what is below it, labels the run from now on.
   */
  void asksForParam(const std::string& key);

  /** @brief Say why this run cannot be repeated exactly. */
  void label(const std::string& reason);

  /** @brief What comes on @p topic from outside is the same in every run (a map): no label for it.
   */
  void constant(const std::string& topic);

  /**
   * @brief For ordinary roscpp parts of this node: nodehandle.setCallbackQueue(outsideQueue()).
   * Their callbacks run as input from outside. Must not outlive the participant.
   */
  ros::CallbackQueueInterface* outsideQueue();

  std::int32_t rank() const;

  /** @brief The node's last report; what it has published still goes out. */
  void leave(const std::string& reason = "");

  /** @return whether the node still takes part. */
  bool active() const;

 private:
  std::optional<std::string> callBytes(const std::string& service,
                                       const ros::SerializedMessage& request);

  std::shared_ptr<internal::Core> core_;
};

/** @brief ros::Rate in a participant. */
class Rate {
 public:
  Rate(Participant& participant, double frequency);
  Rate(Participant& participant, const ros::Duration& cycle);

  /** @brief Sleep until the end of the cycle. @return false if it is over already, or the run. */
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
