// Services between participants: a call is handled in the next round, in the server's queue.
#include <ros/callback_queue_interface.h>
#include <ros/console.h>
#include <ros/master.h>
#include <ros/param.h>
#include <ros/service.h>
#include <ros/service_client.h>
#include <ros/service_manager.h>
#include <ros/service_publication.h>
#include <ros/service_server_link.h>

#include <exception>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "clock/json_text.h"
#include "exchange.h"
#include "node.h"
#include "parameters.h"
#include "roscpp_shim/machine/real.h"
#include "turn.h"
#include "waits.h"

namespace move_base_abstract::shim {
namespace {

using lockstep::internal::Reply;

struct Service {
  std::uint32_t number = 0;
  std::string name;
  ros::ServiceCallbackHelperPtr helper;
  ros::CallbackQueueInterface* queue = nullptr;
  ros::VoidConstWPtr tracked;
  bool is_tracked = false;
};

struct Services {
  std::uint32_t made = 0;
  std::map<std::uint32_t, Service> offered;
};

Services& services() {
  static Services* const instance = new Services;
  return *instance;
}

/** @brief A participant's call, in the queue of the service. */
class MemberCall : public ros::CallbackInterface {
 public:
  MemberCall(Service service, const wire::CallIn& item)
      : service_(std::move(service)),
        caller_(item.caller),
        caller_name_(node().membership().memberOf(item.caller).name),
        number_(item.number),
        request_(item.request) {}

  CallResult call() override {
    const ros::VoidConstPtr tracked = service_.tracked.lock();
    if (service_.is_tracked && !tracked) {
      answer(false, "service " + service_.name + " is not offered any more");
      return Invalid;
    }
    ros::ServiceCallbackHelperCallParams params;
    params.request = messageOf(request_);
    params.connection_header = boost::make_shared<ros::M_string>();
    (*params.connection_header)["callerid"] = caller_name_;
    (*params.connection_header)["service"] = service_.name;
    try {
      const bool is_good = service_.helper->call(params);
      constexpr std::size_t kPrefix = 5;  // of TCPROS: ok and length
      const auto* const bytes = reinterpret_cast<const char*>(params.response.buf.get());
      answer(is_good, is_good
                          ? std::string_view(bytes + kPrefix, params.response.num_bytes - kPrefix)
                          : std::string_view());
    } catch (const std::exception& error) {
      tellUncaught(error.what());
      return Invalid;
    }
    return Success;
  }

 private:
  void answer(bool is_good, std::string_view bytes) const {
    node().append(wire::Response{caller_, number_, is_good, bytes});
  }

  void tellUncaught(const std::string& error) const {
    ROS_ERROR("Exception thrown while processing service call: %s", error.c_str());
    std::string values = "[\"std::exception\",";
    appendJson(values, "the handler of service " + service_.name);
    node().append(wire::Log{0, node().membership().name(), "uncaught", values + "]"});
    answer(false, error);
  }

  Service service_;
  std::uint32_t caller_;
  std::string caller_name_;
  std::uint32_t number_;
  std::string request_;
};

Reply call(const std::string& service, std::string_view request) {
  const std::uint32_t number = node().membership().call(service, request);
  const std::string what = "the answer of " + service;
  Wait wait;
  wait.is_over = [number] { return node().membership().isAnswered(number); };
  node().open(what);
  const Woken woken = turn().wait(wait);
  node().close(what);
  return woken == Woken::kEnd ? Reply() : node().membership().takeAnswer(number);
}

/** @return whether a participant offers the service, as of this instant. */
bool isOffered(const std::string& service) {
  auto& membership = node().membership();
  membership.watch(service);
  Wait wait;
  wait.next_round = membership.lookahead() == 0;
  if (!wait.next_round) {  // after the lookahead it is known whether it is there
    wait.until = node().now() + membership.lookahead();
    wait.is_over = [&] { return membership.isFound(service); };
  }
  turn().wait(wait);
  return membership.isFound(service);
}

/**
 * @return whether a node that has never taken part may offer the service. Participants do not
 * count: they register at the ROS master at moments of the wall clock.
 */
bool mayBeOfferedOutside(const std::string& service) {
  auto& membership = node().membership();
  const Inside inside;
  const std::set<std::string> present = membership.present();
  const std::set<std::string> gone = membership.gone();
  XmlRpc::XmlRpcValue request, response, state;
  request[0] = membership.name();
  if (!ros::master::execute("getSystemState", request, response, state, false)) {
    return false;
  }
  XmlRpc::XmlRpcValue& services = state[2];
  for (int k = 0; k < services.size(); ++k) {
    XmlRpc::XmlRpcValue& nodes = services[k][1];
    for (int i = 0; i < nodes.size() && std::string(services[k][0]) == service; ++i) {
      const std::string one = nodes[i];
      if (present.count(one) + gone.count(one) == 0) {
        return true;
      }
    }
  }
  return false;
}

/** @brief Count a call of a service. In a loop that does nothing but call, time goes on. */
void countCall() {
  constexpr unsigned kCalls = 1000;  // at one instant, after which each takes a while
  countRepeated(&Turn::self()->calls, kCalls, 0, "a service");
}

}  // namespace

void handle(const wire::CallIn& item) {
  const auto found = services().offered.find(item.service);
  if (found == services().offered.end()) {
    node().append(
        wire::Response{item.caller, item.number, false, "the service is not offered any more"});
    return;
  }
  const auto publication =
      ros::ServiceManager::instance()->lookupServicePublication(found->second.name);
  found->second.queue->addCallback(boost::make_shared<MemberCall>(found->second, item),
                                   reinterpret_cast<std::uint64_t>(publication.get()));
}

}  // namespace move_base_abstract::shim

namespace wire = move_base_abstract::wire;

namespace ros {

bool ServiceManager::advertiseService(const AdvertiseServiceOptions& options) {
  static auto* const function =
      shim::real(&ServiceManager::advertiseService, "ros::ServiceManager::advertiseService");
  const bool is_app = shim::turn().enter();
  const shim::Beside beside;
  const bool is_done = function(this, options);
  if (is_app && is_done) {
    shim::Service service;
    service.number = ++shim::services().made;
    service.name = options.service;
    service.helper = options.helper;
    service.queue = options.callback_queue;
    service.tracked = options.tracked_object;
    service.is_tracked = static_cast<bool>(options.tracked_object);
    shim::node().append(wire::Serve{service.number, 0, service.name});
    shim::services().offered[service.number] = service;
  }
  return is_done;
}

bool ServiceManager::unadvertiseService(const std::string& name) {
  static auto* const function =
      shim::real(&ServiceManager::unadvertiseService, "ros::ServiceManager::unadvertiseService");
  if (shim::turn().enter()) {
    auto& offered = shim::services().offered;
    for (auto at = offered.begin(); at != offered.end();) {
      if (at->second.name == name) {
        shim::node().append(wire::Unserve{at->first});
        at = offered.erase(at);
      } else {
        ++at;
      }
    }
  }
  return function(this, name);
}

bool ServiceClient::call(const SerializedMessage& request, SerializedMessage& response,
                         const std::string& md5) {
  static auto* const function =
      shim::real<bool(ServiceClient*, const SerializedMessage&, SerializedMessage&,
                      const std::string&)>("ros::ServiceClient::call");
  if (!shim::turn().enter()) {
    return function(this, request, response, md5);
  }
  shim::Turn::self()->has_acted = true;
  const std::string service = getService();
  const auto head = static_cast<std::size_t>(request.message_start - request.buf.get());
  const move_base_abstract::lockstep::internal::Reply reply = shim::call(
      service, {reinterpret_cast<const char*>(request.message_start), request.num_bytes - head});
  if (reply.status == wire::CallStatus::kNoServer && shim::mayBeOfferedOutside(service)) {
    shim::parameters().keepNoAnswers();  // the server may set some
    shim::node().label("service " + service +
                       ", which was called, is offered by a node that does not take part");
    const shim::Blocking blocking;  // time stands still until the other node has answered
    return function(this, request, response, md5);
  }
  shim::countCall();
  if (reply.status == wire::CallStatus::kNoServer) {
    return false;  // as roscpp does, without a word
  }
  if (!reply.isGood()) {
    ROS_ERROR("Service call failed: service [%s] responded with an error: %s", service.c_str(),
              reply.why().c_str());
    return false;
  }
  response = shim::messageOf(reply.bytes);
  return true;
}

bool ServiceServerLink::call(const SerializedMessage& request, SerializedMessage& response) {
  static auto* const function =
      shim::real(&ServiceServerLink::call, "ros::ServiceServerLink::call");
  const shim::Blocking blocking;  // the answer comes through roscpp's own thread
  return function(this, request, response);
}

namespace service {

bool exists(const std::string& name, bool print_failure_reason) {
  static auto* const function = shim::real(&exists, "ros::service::exists");
  if (shim::turn().enter()) {
    const std::string service = names::resolve(name);
    if (shim::isOffered(service)) {
      return true;
    }
    if (!shim::mayBeOfferedOutside(service)) {
      return false;
    }
  }
  const shim::Blocking blocking;
  return function(name, print_failure_reason);
}

bool waitForService(const std::string& name, Duration timeout) {
  static auto* const function =
      shim::real<bool(const std::string&, Duration)>("ros::service::waitForService");
  if (!shim::turn().enter()) {
    return function(name, timeout);
  }
  const std::string service = names::resolve(name);
  shim::Wait wait;
  wait.until =
      timeout > Duration(0) ? shim::node().now() + timeout.toNSec() : move_base_abstract::kNever;
  if (wait.until > shim::node().now() + shim::node().membership().lookahead()) {
    if (exists(name, false)) {
      return true;
    }
  } else {
    shim::node().membership().watch(service);
  }
  wait.is_over = [&service] { return shim::node().membership().isFound(service); };
  shim::node().open("service " + service);
  const shim::Woken woken = shim::turn().wait(wait);
  shim::node().close("service " + service);
  if (woken == shim::Woken::kTime) {
    shim::tellInVain("service " + service);
  }
  return woken == shim::Woken::kReady;
}

}  // namespace service

}  // namespace ros
