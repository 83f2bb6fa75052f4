// Topics and services of the program as a participant.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_EXCHANGE_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_EXCHANGE_H

#include <string>

#include "lockstep/wire.h"

namespace move_base_abstract::shim {

/** @brief Read which topics the time master leaves to roscpp. */
void readExcludedTopics();
/** @return whether messages on @p topic go through the time master. */
bool isManaged(const std::string& topic);
/** @brief roscpp's connections to a node that has joined carry nothing any more. */
void dropConnectionsTo(const std::string& node);

void handle(const wire::Publisher& item);
void handle(const wire::NoPublisher& item);
void handle(const wire::Subscriber& item);
void handle(const wire::NoSubscriber& item);
void handle(const wire::Deliver& item);
void handle(const wire::CallIn& item);
void handle(const wire::Answer& item);
void handle(const wire::Found& item);

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_EXCHANGE_H
