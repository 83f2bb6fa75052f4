// Puts the mail of a grant into roscpp's publications, subscriptions and callback queues.
#pragma once

#include <ros/serialized_message.h>

#include <string>
#include <string_view>

#include "lockstep/wire/wire.h"

namespace move_base_abstract::shim {

/** @brief Take roscpp's connections to a node that has joined out of use. */
void dropConnectionsTo(const std::string& node);

/** @return the message of a payload from a frame. */
ros::SerializedMessage messageOf(std::string_view payload);

void handle(const wire::Publisher& item);
void handle(const wire::NoPublisher& item);
void handle(const wire::Subscriber& item);
void handle(const wire::NoSubscriber& item);
void handle(const wire::Deliver& item);
void handle(const wire::CallIn& item);

}  // namespace move_base_abstract::shim
