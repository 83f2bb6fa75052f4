// The sockets that participants connect to. No ROS.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_SOCKETS_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_SOCKETS_H

#include <sys/types.h>

#include <string>

#include "descriptor.h"

namespace move_base_abstract {

/** @return the owner of @p fd. @throws std::runtime_error naming @p what if it is negative (errno).
 */
Descriptor checked(int fd, const char* what);

/**
 * @return a socket that listens on a TCP port; @param port 0: any free one.
 * @throws std::runtime_error if there is none, saying why.
 */
Descriptor listenOn(const std::string& host, int port);

/** @return the TCP port that a socket is bound to. */
int portOf(const Descriptor& socket);

/**
 * @return a Unix socket for participants of this computer, named after @p address ("host:port");
 * none where the address is too long for that: they come by TCP then.
 * @throws std::runtime_error if it cannot listen.
 */
Descriptor listenLocally(const std::string& address);

/** @return the process at the other end; 0: it is on another computer, or cannot be seen. */
pid_t processOf(const Descriptor& socket);

/** @brief Small frames go out at once; a computer that has lost its power is noticed. */
void tuneConnection(const Descriptor& socket);

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_SOCKETS_H
