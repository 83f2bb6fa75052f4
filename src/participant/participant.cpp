// The public classes of a participant; core.cpp and topics.cpp do the work.
#include <ros/init.h>
#include <ros/names.h>

#include <algorithm>
#include <utility>

#include "core.h"
#include "move_base_abstract/lockstep_participant.h"
#include "parameter_text.h"

namespace move_base_abstract::lockstep {

using internal::Core;

namespace {

/**
 * @return the instant [ns] that is @p duration after the present; the present if @p duration is
 * negative.
 */
Nanoseconds after(const Core& core, const ros::Duration& duration) {
  return addSaturated(core.now(), std::max<Nanoseconds>(duration.toNSec(), 0));
}

/** @return the end of a wait [ns], or kNever. */
Nanoseconds endOf(const Core& core, const std::optional<ros::Duration>& timeout) {
  return timeout ? after(core, *timeout) : kNever;
}

}  // namespace

std::uint32_t Publisher::getNumSubscribers() const {
  const auto core = publication_ ? publication_->core() : nullptr;
  return core ? core->subscribers(publication_->topic()) : 0;
}

std::string Publisher::getTopic() const {
  const auto core = publication_ ? publication_->core() : nullptr;
  return core ? publication_->topic().name : "";
}

void Publisher::publishBytes(const ros::SerializedMessage& message, const std::string& md5) const {
  const auto core = publication_ ? publication_->core() : nullptr;
  if (!core) {
    throw Error("lockstep: publish on a Publisher that is empty or has outlived its Participant");
  }
  core->publish(publication_->topic(), message, md5);
}

std::string Subscriber::getTopic() const {
  const auto core = subscription_ ? subscription_->core() : nullptr;
  return core ? subscription_->topic().name : "";
}

std::uint32_t Subscriber::getNumPublishers() const {
  const auto core = subscription_ ? subscription_->core() : nullptr;
  return core ? static_cast<std::uint32_t>(subscription_->topic().publishers.size()) : 0;
}

void Timer::stop() {
  if (state_) {
    state_->stop();
  }
}

void Timer::start() {
  if (state_) {
    state_->start();
  }
}

bool Timer::isRunning() const { return state_ && state_->isRunning(); }

namespace {

// The core of the present Participant, for calls that have no Participant at hand. They come from
// its thread.
std::weak_ptr<Core>& present() {
  static auto* const instance = new std::weak_ptr<Core>;
  return *instance;
}

}  // namespace

/**
 * @brief Write a row for move_base_abstract/properties.h, which finds this by name. @return 0 if it
 * was taken.
 */
extern "C" __attribute__((visibility("default"))) int move_base_abstract_log_row(
    const char* kind, const char* values) {
  try {
    const std::shared_ptr<Core> core = present().lock();
    if (core) {
      core->check(kind);
      core->append(wire::Log{0, core->name(), kind, values});
      return 0;
    }
  } catch (const Error&) {  // called from another thread, or after the run
  }
  return 1;
}

Participant::Participant(const Options& options) {
  if (!ros::isInitialized()) {
    throw Error("lockstep: a Participant was made before ros::init");
  }
  core_ = std::make_shared<Core>(options);
  core_->join();
  present() = core_;
}

Participant::~Participant() { core_->leave(""); }

Publisher Participant::advertise(const ros::AdvertiseOptions& options) {
  return Publisher(core_->advertise(options));
}

Subscriber Participant::subscribe(const ros::SubscribeOptions& options) {
  return Subscriber(core_->subscribe(options));
}

ServiceServer Participant::advertiseService(const ros::AdvertiseServiceOptions& options) {
  return ServiceServer(core_->serve(options));
}

std::optional<std::string> Participant::callBytes(const std::string& service,
                                                  const ros::SerializedMessage& request) {
  return core_->call(service, request);
}

bool Participant::waitForService(const std::string& service,
                                 const std::optional<ros::Duration>& timeout) {
  return core_->waitForService(service, endOf(*core_, timeout));
}

ros::Time Participant::now() const {
  return ros::Time().fromNSec(static_cast<std::uint64_t>(core_->now()));
}

std::uint32_t Participant::microstep() const { return core_->microstep(); }

bool Participant::sleep(const ros::Duration& duration) {
  core_->check("sleep");
  return core_->wait(after(*core_, duration), Core::Callbacks::kRun) == Core::Woken::kTime;
}

bool Participant::sleepUntil(const ros::Time& time) {
  core_->check("sleepUntil");
  return core_->wait(static_cast<Nanoseconds>(time.toNSec()), Core::Callbacks::kRun) ==
         Core::Woken::kTime;
}

void Participant::spin() {
  core_->checkOutsideCallback("spin");
  core_->wait(kNever, Core::Callbacks::kRun);
}

bool Participant::spinOnce() {
  core_->checkOutsideCallback("spinOnce");
  return core_->giveWay();
}

bool Participant::spinUntil(const std::function<bool()>& done,
                            const std::optional<ros::Duration>& timeout, const std::string& what) {
  core_->checkOutsideCallback("spinUntil");
  const Nanoseconds until = endOf(*core_, timeout);
  return core_->wait(until, Core::Callbacks::kRun, done, what) == Core::Woken::kDone;
}

Timer Participant::createTimer(const ros::Duration& period,
                               std::function<void(const ros::TimerEvent&)> callback, bool oneshot,
                               bool autostart) {
  core_->check("createTimer");
  const Nanoseconds nanoseconds = period.toNSec();
  if (nanoseconds < 0 || (nanoseconds == 0 && !oneshot)) {
    throw Error("lockstep: the period of a timer of " + core_->name() +
                " must be more than 0 s (a oneshot timer's may be 0), got " +
                std::to_string(period.toSec()));
  }
  auto state =
      std::make_shared<internal::TimerState>(core_, nanoseconds, std::move(callback), oneshot);
  if (autostart) {
    state->start();
  }
  return Timer(std::move(state));
}

void Participant::log(const std::string& robot, const std::string& kind, const std::string& values,
                      std::uint32_t sub) {
  core_->check("log");
  core_->append(wire::Log{sub, robot, kind, values});
}

void Participant::setParam(const std::string& key, const XmlRpc::XmlRpcValue& value) {
  core_->check("setParam");
  const std::string name = ros::names::resolve(key);
  const std::string text = internal::parameterText(value);
  if (text.empty()) {
    throw Error("lockstep: setParam of " + core_->name() + ": the value of " + name +
                " must have a type, with all that is in it, and its texts must be UTF-8 without "
                "control characters");
  }
  core_->append(wire::Parameter{name, true, text});
}

void Participant::deleteParam(const std::string& key) {
  core_->check("deleteParam");
  core_->append(wire::Parameter{ros::names::resolve(key), false, ""});
}

void Participant::asksForParam(const std::string& key) {
  core_->check("asksForParam");
  core_->append(wire::Asks{ros::names::resolve(key)});
}

void Participant::label(const std::string& reason) {
  core_->check("label");
  core_->label(reason);
}

void Participant::constant(const std::string& topic) {
  core_->check("constant");
  core_->makeConstant(topic);
}

ros::CallbackQueueInterface* Participant::outsideQueue() { return &core_->userQueue(); }

std::int32_t Participant::rank() const { return core_->rank(); }

void Participant::leave(const std::string& reason) {
  if (core_->isActive()) {
    core_->check("leave");
    core_->leave(reason);
  }
}

bool Participant::active() const { return core_->isActive(); }

Rate::Rate(Participant& participant, double frequency)
    : Rate(participant, ros::Duration(1.0 / frequency)) {}

Rate::Rate(Participant& participant, const ros::Duration& cycle)
    : participant_(participant), cycle_(cycle), start_(participant.now()) {
  if (cycle <= ros::Duration(0)) {
    throw Error("lockstep: the cycle of a Rate must be more than 0 s, got " +
                std::to_string(cycle.toSec()));
  }
}

bool Rate::sleep() {
  const ros::Time end = start_ + cycle_;
  const ros::Time now = participant_.now();
  if (now < end) {
    start_ = end;
    return participant_.sleepUntil(end);
  }
  start_ = now > end + cycle_ ? now : end;  // far behind: start again, as ros::Rate does
  return false;
}

void Rate::reset() { start_ = participant_.now(); }

}  // namespace move_base_abstract::lockstep
