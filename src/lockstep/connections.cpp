#include "connections.h"

#include <utility>

#include "clock/shown_text.h"

namespace move_base_abstract {

void Connections::add(ConnectionId id, Nanoseconds hello_due) {
  connections_[id];
  hello_due_[id] = hello_due;
}

MemberId Connections::remove(ConnectionId id) {
  const auto found = connections_.find(id);
  const MemberId member = found == connections_.end() ? 0 : found->second.member;
  if (found != connections_.end()) {
    connections_.erase(found);
  }
  hello_due_.erase(id);
  return member;
}

void Connections::greeted(ConnectionId id, MemberId member) {
  connections_.at(id).member = member;
  hello_due_.erase(id);
}

Connection* Connections::open(ConnectionId id) {
  const auto found = connections_.find(id);
  return found == connections_.end() || found->second.close ? nullptr : &found->second;
}

MemberId Connections::memberOf(ConnectionId id) const {
  const auto found = connections_.find(id);
  return found == connections_.end() ? 0 : found->second.member;
}

ConnectionId Connections::silentStranger(Nanoseconds wall) const {
  return helloDue() <= wall && !hello_due_.empty() ? hello_due_.begin()->first : 0;
}

void Connections::send(ConnectionId id, std::string_view bytes,
                       std::optional<std::uint32_t> topic) {
  Connection* const connection = open(id);
  if (connection == nullptr) {
    return;
  }
  connection->out.append(bytes);
  connection->topic = topic ? topic : connection->topic;
  if (!connection->listed) {
    connection->listed = true;
    outgoing_.push_back(id);
  }
}

void Connections::close(ConnectionId id, const std::string& reason, bool as_wished) {
  Connection* const connection = open(id);
  if (connection == nullptr) {
    return;
  }
  const std::string text = shown(reason);
  send(id, wire::encode(wire::MasterFrame(wire::End{text, as_wished})));
  connection->close = true;
  hello_due_.erase(id);
}

void Connections::closeAll(const std::string& reason, bool as_wished) {
  for (const auto& [id, connection] : connections_) {
    close(id, reason, as_wished);
  }
}

std::vector<ConnectionOutput> Connections::flush() {
  std::vector<ConnectionOutput> outputs;
  for (const ConnectionId id : outgoing_) {
    const auto found = connections_.find(id);
    if (found == connections_.end()) {
      continue;
    }
    Connection& connection = found->second;
    connection.listed = false;
    outputs.push_back({id, std::move(connection.out), connection.close,
                       std::exchange(connection.topic, std::nullopt)});
    connection.out.clear();
    if (connection.close) {
      connections_.erase(found);
    }
  }
  outgoing_.clear();
  return outputs;
}

}  // namespace move_base_abstract
