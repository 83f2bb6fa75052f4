// The implementation of a Participant: mail, timers and topics, in one thread.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_CORE_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_CORE_H

#include <ros/node_handle.h>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "membership.h"
#include "move_base_abstract/lockstep_participant.h"
#include "outside.h"
#include "services.h"
#include "timer_state.h"
#include "topics.h"

namespace move_base_abstract::lockstep::internal {

/** @brief The participant's state. The participant has its turn, except inside wait(). */
class Core : public Program, public std::enable_shared_from_this<Core> {
 public:
  enum class Woken { kDone, kTime, kOver };
  enum class Callbacks { kRun, kWait };

  explicit Core(const Options& options);
  ~Core() override;

  /** @brief Connect, present the node, and wait for its first grant. @throws Error, NotLockstep */
  void join();
  void leave(const std::string& reason);
  bool isActive() const { return membership_.isActive(); }

  /**
   * @brief Give the turn away until @p done() is true or simulated time has come to @p until.
   * Callbacks run meanwhile, or wait until afterwards (inside a callback they always wait).
   * @param what names what the node waits for, if the wait has no timeout.
   */
  Woken wait(Nanoseconds until, Callbacks callbacks, const std::function<bool()>& done = nullptr,
             const std::string& what = "");
  bool giveWay();

  /** @throws Error if another thread calls, or the participant has left. */
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

  void append(const wire::ReportItem& item) { membership_.append(item); }
  void label(const std::string& reason) { membership_.label(reason); }
  void makeConstant(const std::string& topic);
  void schedule(TimerState& timer);
  void unschedule(TimerState& timer);
  std::uint64_t nextTimerNumber() { return ++timers_made_; }

  Nanoseconds now() const { return membership_.now(); }
  std::uint32_t microstep() const { return membership_.microstep(); }
  std::int32_t rank() const { return membership_.rank(); }
  OutsideQueue& userQueue() { return *user_queue_; }
  const std::string& name() const { return membership_.name(); }

 private:
  // Program
  void setTime(Nanoseconds now) override;
  void handle(const wire::Publisher& item) override;
  void handle(const wire::NoPublisher& item) override;
  void handle(const wire::Subscriber& item) override;
  void handle(const wire::NoSubscriber& item) override;
  void handle(const wire::Deliver& item) override;
  void handle(const wire::CallIn& item) override;
  void onGranted() override;
  void beforeGone() override { takeOutside(); }
  bool hasInput() override;
  bool waitsOn() override;
  void onEnd() override;
  void lock() override { mutex_.lock(); }
  void unlock() override { mutex_.unlock(); }

  void takeOutside();
  void enterOutside();
  void runCallbacks();
  void runOne(const std::function<void()>& callback);
  TimerState* dueTimer() const;
  Nanoseconds nextDue(Nanoseconds until, Callbacks callbacks) const;
  void endIfRosHas();

  Topic& topicOf(const std::string& name);
  void deliver(const std::shared_ptr<Subscription>& subscription, const HeaderPtr& header,
               const std::string& payload);
  void fromOutside(const std::weak_ptr<Subscription>& subscription,
                   const ros::MessageEvent<void const>& event);
  bool isCopy(Topic& topic, const std::string& sender, const Copies::Connection& connection);
  void connectionChanged(std::uint32_t topic, const std::string& node, bool connected);
  bool hasOutsiders(const Topic& topic);
  ros::NodeHandle& nodeFor(const std::string& name, std::string* rest);

  const std::thread::id thread_ = std::this_thread::get_id();
  std::mutex mutex_;  // for the membership, which another thread reads
  ros::NodeHandle node_;
  ros::NodeHandle private_node_{"~"};

  Membership membership_{*this};
  std::shared_ptr<OutsideQueue> own_queue_ = std::make_shared<OutsideQueue>(membership_.bell());
  std::shared_ptr<OutsideQueue> user_queue_ = std::make_shared<OutsideQueue>(membership_.bell());
  bool is_in_callback_ = false;

  TopicTable<Topic> topics_;
  std::map<std::uint32_t, std::weak_ptr<Service>> services_;
  std::uint32_t services_made_ = 0;
  std::deque<std::function<void()>> mail_;
  std::deque<std::function<void()>> outside_;  // to enter with the next grant
  std::map<std::pair<Nanoseconds, std::uint64_t>, TimerState*> timers_;  // by (due, creation)
  std::uint64_t timers_made_ = 0;
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_CORE_H
