// Requests to the XML-RPC server of a node, or of the ROS master, with a limit on the wait.
#pragma once

#include <netdb.h>
#include <poll.h>
#include <ros/master.h>
#include <ros/this_node.h>
#include <sys/socket.h>
#include <unistd.h>
#include <xmlrpcpp/XmlRpcClient.h>

#include <chrono>
#include <memory>
#include <string>

namespace move_base_abstract {

using WallClock = std::chrono::steady_clock;

/**
 * @brief One XML-RPC server, and a connection to it, which is kept. Make no more requests after one
 * has failed.
 */
class NodeProbe : private XmlRpc::XmlRpcClient {
 public:
  NodeProbe(const std::string& host, int port) : XmlRpcClient(host.c_str(), port, "/") {}

  /** @return whether the node answered within @p limit [wall]. */
  bool answers(std::chrono::milliseconds limit) {
    XmlRpc::XmlRpcValue request, result;
    request[0] = ros::this_node::getName();
    return call("getPid", request, limit, result);
  }

  /**
   * @return whether an answer came within @p limit [wall] and was a success. @p result gets its
   * value.
   */
  bool call(const char* method, const XmlRpc::XmlRpcValue& request, std::chrono::milliseconds limit,
            XmlRpc::XmlRpcValue& result) {
    XmlRpc::XmlRpcValue answer;
    return ask(method, request, limit, answer) && accept(answer, result);
  }

  /** @return whether any answer came within @p limit [wall]. @p answer gets it unchanged. */
  bool ask(const char* method, const XmlRpc::XmlRpcValue& request, std::chrono::milliseconds limit,
           XmlRpc::XmlRpcValue& answer) {
    if (!executeNonBlock(method, request)) {
      return false;
    }
    const auto deadline = WallClock::now() + limit;
    while (WallClock::now() < deadline) {
      _disp.work(0.05);
      if (executeCheckDone(answer)) {
        return true;
      }
    }
    return false;
  }

 private:
  static bool accept(XmlRpc::XmlRpcValue& answer, XmlRpc::XmlRpcValue& result) {
    if (!answer.valid() || answer.getType() != XmlRpc::XmlRpcValue::TypeArray ||
        answer.size() != 3 || answer[0].getType() != XmlRpc::XmlRpcValue::TypeInt) {
      return false;
    }
    result = answer[2];
    return static_cast<int>(answer[0]) == 1;
  }
};

/** @return a connection to the ROS master. */
inline NodeProbe masterProbe() {
  return NodeProbe(ros::master::getHost(), static_cast<int>(ros::master::getPort()));
}

/** @return whether a program accepts connections there within @p limit [wall]. */
inline bool canConnect(const std::string& host, uint32_t port, std::chrono::milliseconds limit) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found) != 0) {
    return false;
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> addresses(found, &freeaddrinfo);
  bool connected = false;
  for (const addrinfo* one = found; one != nullptr && !connected; one = one->ai_next) {
    const int fd = socket(one->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd < 0) {
      continue;
    }
    connected = connect(fd, one->ai_addr, one->ai_addrlen) == 0;
    pollfd waiting{fd, POLLOUT, 0};
    if (!connected && errno == EINPROGRESS &&
        poll(&waiting, 1, static_cast<int>(limit.count())) == 1) {
      int error = 0;
      socklen_t size = sizeof(error);
      connected = getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0;
    }
    close(fd);
  }
  return connected;
}

}  // namespace move_base_abstract
