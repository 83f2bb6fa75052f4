#include "sockets.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "common/local_address.h"

namespace move_base_abstract {
namespace {

[[noreturn]] void fail(const std::string& what, int error) {
  throw std::runtime_error("lockstep: " + what + ": " + std::strerror(error));
}

template <typename Value>
void setOption(int fd, int level, int option, Value value) {
  setsockopt(fd, level, option, &value, sizeof(value));
}

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

Addresses addressesOf(const std::string& host, int port) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found);
  if (error != 0) {
    throw std::runtime_error("lockstep: the host name '" + host + "' is not known (" +
                             gai_strerror(error) + "); set ROS_IP to an address of this computer");
  }
  return {found, &freeaddrinfo};
}

}  // namespace

Descriptor checked(int fd, const char* what) {
  if (fd < 0) {
    fail(what, errno);
  }
  return Descriptor(fd);
}

Descriptor listenOn(const std::string& host, int port) {
  const Addresses addresses = addressesOf(host, port);
  int error = EADDRNOTAVAIL;
  for (const addrinfo* one = addresses.get(); one != nullptr; one = one->ai_next) {
    Descriptor fd(socket(one->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    setOption(fd.get(), SOL_SOCKET, SO_REUSEADDR, 1);
    if (fd.get() >= 0 && bind(fd.get(), one->ai_addr, one->ai_addrlen) == 0 &&
        ::listen(fd.get(), SOMAXCONN) == 0) {
      return fd;
    }
    error = errno;
  }
  fail("cannot listen on " + host + ":" + std::to_string(port) +
           " (lockstep_port; ROS_IP and ROS_HOSTNAME say which address)",
       error);
}

int portOf(const Descriptor& socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.ss_family == AF_INET6
                   ? reinterpret_cast<const sockaddr_in6*>(&address)->sin6_port
                   : reinterpret_cast<const sockaddr_in*>(&address)->sin_port);
}

Descriptor listenLocally(const std::string& address) {
  const LocalAddress local = localAddressOf(address);
  if (local.size == 0) {
    return Descriptor();
  }
  Descriptor listener =
      checked(socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), "socket");
  if (bind(listener.get(), local.get(), local.size) != 0 ||
      ::listen(listener.get(), SOMAXCONN) != 0) {
    fail("cannot listen on the Unix socket @" + std::string(local.name.sun_path + 1), errno);
  }
  return listener;
}

pid_t processOf(const Descriptor& socket) {
  ucred peer{};
  socklen_t size = sizeof(peer);
  return getsockopt(socket.get(), SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 ? peer.pid : 0;
}

void tuneConnection(const Descriptor& socket) {
  const int fd = socket.get();
  setOption(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  setOption(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  setOption(fd, IPPROTO_TCP, TCP_KEEPIDLE, 10);  // s
  setOption(fd, IPPROTO_TCP, TCP_KEEPINTVL, 5);  // s
  setOption(fd, IPPROTO_TCP, TCP_KEEPCNT, 4);
  setOption(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, 30'000U);  // ms
}

}  // namespace move_base_abstract
