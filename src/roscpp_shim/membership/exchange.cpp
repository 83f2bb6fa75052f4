#include "exchange.h"

#include <cstring>
#include <exception>

#include "clock/json_text.h"

namespace move_base_abstract::lockstep::internal {

void advertise(Membership& membership, SharedTopic& topic, const ros::AdvertiseOptions& options) {
  if (!topic.is_advertised && !membership.isExcluded(topic.name)) {
    topic.is_advertised = true;
    membership.append(wire::Advertise{topic.number, 0, topic.name, options.datatype, options.md5sum,
                                      options.latch, options.message_definition});
  }
}

void unadvertise(Membership& membership, SharedTopic& topic) {
  if (topic.is_advertised) {
    topic.is_advertised = false;
    membership.append(wire::Unadvertise{topic.number});
  }
}

void subscribe(Membership& membership, SharedTopic& topic, const ros::SubscribeOptions& options) {
  if (!topic.is_subscribed && !membership.isExcluded(topic.name)) {
    topic.is_subscribed = true;
    membership.append(wire::Subscribe{topic.number, 0, topic.name, options.md5sum});
  }
}

void unsubscribe(Membership& membership, SharedTopic& topic) {
  if (topic.is_subscribed) {
    topic.is_subscribed = false;
    membership.append(wire::Unsubscribe{topic.number});
  }
}

ros::M_string headerOf(const wire::Publisher& item, const std::string& sender,
                       const std::string& topic) {
  return {{"callerid", sender},
          {"topic", topic},
          {"type", std::string(item.type)},
          {"md5sum", std::string(item.md5)},
          {"message_definition", std::string(item.definition)},
          {"latching", item.latched ? "1" : "0"}};
}

std::string_view payloadOf(const ros::SerializedMessage& message) {
  const auto head = static_cast<std::size_t>(message.message_start - message.buf.get());
  return {reinterpret_cast<const char*>(message.message_start), message.num_bytes - head};
}

ros::SerializedMessage messageOf(std::string_view payload) {
  const boost::shared_array<std::uint8_t> bytes(new std::uint8_t[payload.size() + 1]);
  std::memcpy(bytes.get(), payload.data(), payload.size());
  return {bytes, payload.size()};
}

std::string uncaughtOf(const std::string& service) {
  std::string values = "[\"std::exception\",";
  appendJson(values, "the handler of service " + service);
  return values + "]";
}

Handled handleCall(ros::ServiceCallbackHelper& helper, const std::string& service,
                   const std::string& caller, std::string_view request) {
  ros::ServiceCallbackHelperCallParams params;
  params.request = messageOf(request);
  params.connection_header = boost::make_shared<ros::M_string>();
  (*params.connection_header)["callerid"] = caller;
  (*params.connection_header)["service"] = service;
  Handled handled;
  try {
    handled.is_good = helper.call(params);
  } catch (const std::exception& error) {
    handled.error = error.what();
    return handled;
  }
  if (handled.is_good) {
    constexpr std::size_t kPrefix = 5;  // of TCPROS: ok and length
    handled.response.assign(reinterpret_cast<const char*>(params.response.buf.get()) + kPrefix,
                            params.response.num_bytes - kPrefix);
  }
  return handled;
}

}  // namespace move_base_abstract::lockstep::internal
