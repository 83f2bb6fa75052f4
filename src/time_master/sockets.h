// The sockets that participants connect to. No ROS.
#pragma once

#include <sys/types.h>

#include <string>

#include "descriptor.h"

namespace move_base_abstract {

/**
 * @return an owner of @p fd. @throws std::runtime_error with @p what and errno, if @p fd is
 * negative.
 */
Descriptor checked(int fd, const char* what);

/**
 * @param port 0: any free one.
 * @return a socket that listens on a TCP port.
 * @throws std::runtime_error with the reason, if it cannot listen.
 */
Descriptor listenOn(const std::string& host, int port);

/** @return the TCP port that a socket is bound to. */
int portOf(const Descriptor& socket);

/**
 * @return a Unix socket for participants on this computer, named after @p address ("host:port");
 * none if the address is too long for that. Then they connect by TCP.
 * @throws std::runtime_error if it cannot listen.
 */
Descriptor listenLocally(const std::string& address);

/** @return the process at the other end; 0: it is on another computer, or is not known. */
pid_t processOf(const Descriptor& socket);

/** @brief Let small frames go out at once, and notice if the other computer has lost its power. */
void tuneConnection(const Descriptor& socket);

}  // namespace move_base_abstract
