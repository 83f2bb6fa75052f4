#include "services.h"

#include <ros/console.h>

#include "core.h"
#include "exchange.h"

namespace move_base_abstract::lockstep::internal {

// ---- services --------------------------------------------------------------------------------

std::shared_ptr<Service> Core::serve(const ros::AdvertiseServiceOptions& options) {
  check("advertiseService");
  std::string rest;
  ros::NodeHandle& node = nodeFor(options.service, &rest);
  const std::string name = node.resolveName(rest);
  const std::uint32_t number = ++services_made_;
  const auto service = std::make_shared<Service>(shared_from_this(), number, name, options.helper);
  ros::AdvertiseServiceOptions outside = options;
  outside.service = rest;
  service->listenOutside(node, user_queue_, outside);
  append(wire::Serve{number, 0, name});
  services_[number] = service;
  return service;
}

void Service::listenOutside(ros::NodeHandle& node, const std::shared_ptr<OutsideQueue>& queue,
                            ros::AdvertiseServiceOptions options) {
  queue_ = queue;
  options.callback_queue = queue.get();
  outside_ = node.advertiseService(options);
  if (!outside_) {
    throw Error("lockstep: service " + name_ + " is offered by this node already");
  }
}

Service::~Service() {
  const auto core = core_.lock();
  if (core && outside_) {
    core->unserve(number_);
  }
}

void Core::unserve(std::uint32_t service) {
  append(wire::Unserve{service});
  services_.erase(service);
}

void Service::answer(std::uint32_t caller, std::uint32_t number, const std::string& caller_name,
                     std::string_view request) {
  const auto core = core_.lock();
  const Handled handled = handleCall(*helper_, name_, caller_name, request);
  std::string failure = "service " + name_ + " of " + core->name() + " returned false";
  if (!handled.error.empty()) {
    failure = "service " + name_ + " of " + core->name() + " failed: " + handled.error;
    ROS_ERROR("lockstep: %s", failure.c_str());
    core->append(wire::Log{0, core->name(), "uncaught", uncaughtOf(name_)});
  }
  core->append(wire::Response{caller, number, handled.is_good,
                              handled.is_good ? handled.response : failure});
}

void Core::handle(const wire::CallIn& item) {
  const std::string caller_name = membership_.nameOf(item.caller);
  mail_.emplace_back([this, service = item.service, caller = item.caller, number = item.number,
                      caller_name, request = std::string(item.request)] {
    const auto found = services_.find(service);
    const auto alive = found == services_.end() ? nullptr : found->second.lock();
    if (alive) {
      alive->answer(caller, number, caller_name, request);
    } else {
      append(wire::Response{caller, number, false, name() + " no longer offers this service"});
    }
  });
}

std::optional<std::string> Core::call(const std::string& service,
                                      const ros::SerializedMessage& request) {
  check("call");
  std::string rest;
  const std::string name = nodeFor(service, &rest).resolveName(rest);
  const std::uint32_t number = membership_.call(name, payloadOf(request));
  const auto is_answered = [this, number] { return membership_.isAnswered(number); };
  const auto woken = wait(kNever, Callbacks::kWait, is_answered, "an answer of " + name);
  if (woken != Woken::kDone) {
    return std::nullopt;
  }
  Reply reply = membership_.takeAnswer(number);
  if (reply.isGood()) {
    return std::move(reply.bytes);
  }
  ROS_ERROR("lockstep: a call of %s by %s failed: %s", name.c_str(), this->name().c_str(),
            reply.why().c_str());
  return std::nullopt;
}

bool Core::waitForService(const std::string& service, Nanoseconds until) {
  check("waitForService");
  std::string rest;
  const std::string name = nodeFor(service, &rest).resolveName(rest);
  membership_.watch(name);
  const auto is_found = [this, &name] { return membership_.isFound(name); };
  return wait(until, Callbacks::kWait, is_found, "service " + name) == Woken::kDone;
}

}  // namespace move_base_abstract::lockstep::internal
