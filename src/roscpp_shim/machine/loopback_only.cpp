// Makes the XML-RPC server of a roscpp program listen on the loopback address, if ROS_HOSTNAME or
// ROS_IP names one. rospy does so, and roscpp does so for its topics. Without this, the server
// listens on all addresses, and everybody who reaches the computer can shut the program down.
// This file is also a library of its own, for programs that take no part. It uses no ROS.
#include <arpa/inet.h>
#include <dlfcn.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace {

/** @return the loopback address that the program announces; INADDR_ANY: none. */
in_addr announcedLoopback() {
  in_addr address{};
  address.s_addr = htonl(INADDR_ANY);
  const char* host = std::getenv("ROS_HOSTNAME");
  host = host == nullptr ? std::getenv("ROS_IP") : host;
  if (host != nullptr && std::strcmp(host, "localhost") == 0) {
    address.s_addr = htonl(INADDR_LOOPBACK);
  } else if (host != nullptr && std::strncmp(host, "127.", 4) == 0) {
    inet_aton(host, &address);
  }
  return address;
}

bool isXmlRpc(const void* caller) {
  Dl_info info{};
  return dladdr(caller, &info) != 0 && info.dli_fname != nullptr &&
         std::strstr(info.dli_fname, "/libxmlrpcpp.so") != nullptr;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) int bind(int fd, const sockaddr* address,
                                                           socklen_t size) noexcept {
  sockaddr_in own{};
  if (address != nullptr && address->sa_family == AF_INET && size >= sizeof own &&
      isXmlRpc(__builtin_return_address(0))) {
    std::memcpy(&own, address, sizeof own);
    if (own.sin_addr.s_addr == htonl(INADDR_ANY)) {
      own.sin_addr = announcedLoopback();
      return static_cast<int>(::syscall(SYS_bind, fd, &own, sizeof own));
    }
  }
  return static_cast<int>(::syscall(SYS_bind, fd, address, size));
}
