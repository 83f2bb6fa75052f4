// Where participants on the time master's own computer connect to it: a Unix socket without a file.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_LOCAL_ADDRESS_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_LOCAL_ADDRESS_H

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cstddef>
#include <string>

namespace move_base_abstract {

/** @brief An address that bind() and connect() take. */
struct LocalAddress {
  sockaddr_un name{};
  socklen_t size = 0;  // 0: there is none, the name is too long

  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&name); }
};

/**
 * @return the abstract Unix address that goes with the TCP @p address, "host:port".
 *
 * It follows from that one, so nobody needs to be told; both are of the same network namespace. A
 * round trip over it takes two thirds of what one over TCP takes.
 */
inline LocalAddress localAddressOf(const std::string& address) {
  const std::string text = "move_base_abstract/" + address;
  LocalAddress local;
  local.name.sun_family = AF_UNIX;
  if (text.size() + 1 <= sizeof(local.name.sun_path)) {
    std::copy(text.begin(), text.end(), local.name.sun_path + 1);  // behind a 0: no file
    local.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
  }
  return local;
}

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_LOCAL_ADDRESS_H
