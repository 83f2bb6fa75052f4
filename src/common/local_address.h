// The address for participants on the time master's own computer: a Unix socket without a file.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cstddef>
#include <string>

namespace move_base_abstract {

/** @brief An address for bind() and connect(). */
struct LocalAddress {
  sockaddr_un name{};
  socklen_t size = 0;  // 0: none, because the name is too long

  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&name); }
};

/**
 * @return the abstract Unix address that belongs to the TCP @p address, "host:port".
 *
 * It follows from the TCP address, so it need not be passed on. Both belong to the same network
 * namespace. A round trip takes two thirds of the time that it takes over TCP.
 */
inline LocalAddress localAddressOf(const std::string& address) {
  const std::string text = "move_base_abstract/" + address;
  LocalAddress local;
  local.name.sun_family = AF_UNIX;
  if (text.size() + 1 <= sizeof(local.name.sun_path)) {
    std::copy(text.begin(), text.end(), local.name.sun_path + 1);  // after a 0: no file
    local.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
  }
  return local;
}

}  // namespace move_base_abstract
