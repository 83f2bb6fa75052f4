#include "own_address.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <ros/network.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <memory>
#include <regex>
#include <string>

namespace move_base_abstract {
namespace {

/** @return the IPv4 address that ROS announces; INADDR_ANY before ros::init, or if there is none.
 */
in_addr announced() {
  in_addr address{};
  address.s_addr = htonl(INADDR_ANY);
  const std::string& host = ros::network::getHost();
  addrinfo wanted{};
  wanted.ai_family = AF_INET;
  addrinfo* found = nullptr;
  if (!host.empty() && getaddrinfo(host.c_str(), nullptr, &wanted, &found) == 0) {
    const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(found, &freeaddrinfo);
    address = reinterpret_cast<const sockaddr_in*>(found->ai_addr)->sin_addr;
  }
  return address;
}

}  // namespace

void setDefaultAddress() {
  static const std::regex local_master(R"(https?://(localhost|127\.[0-9.]+)(:.*|/.*|))");
  const char* const master = std::getenv("ROS_MASTER_URI");
  if (std::getenv("ROS_IP") == nullptr && std::getenv("ROS_HOSTNAME") == nullptr &&
      (master == nullptr || std::regex_match(master, local_master))) {
    setenv("ROS_IP", "127.0.0.1", 0);
  }
}

}  // namespace move_base_abstract

extern "C" __attribute__((visibility("default"))) int bind(int fd, const sockaddr* address,
                                                           socklen_t size) {
  const auto really = [fd, size](const sockaddr* where) {
    return static_cast<int>(syscall(SYS_bind, fd, where, size));
  };
  sockaddr_in own{};
  if (address != nullptr && address->sa_family == AF_INET && size >= sizeof(own)) {
    own = *reinterpret_cast<const sockaddr_in*>(address);
    if (own.sin_addr.s_addr == htonl(INADDR_ANY)) {
      own.sin_addr = move_base_abstract::announced();
      if (really(reinterpret_cast<const sockaddr*>(&own)) == 0) {
        return 0;
      }
      if (errno != EADDRNOTAVAIL) {
        return -1;
      }  // otherwise it belongs to a computer in front of this one that forwards connections
    }
  }
  return really(address);
}
