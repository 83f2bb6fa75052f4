// Publishes the states of the radio's links for onlookers, when they change.
#pragma once

#include <ros/publisher.h>

#include "clock/scaled_clock.h"
#include "lockstep_server.h"

namespace move_base_abstract {

/** @brief The latched topic /time_master/links. A run without a radio does not have it. */
class RadioPublisher {
 public:
  /**
   * @brief Publish, if something has changed and the last message is old enough. @param wall the
   * wall instant [ns].
   */
  void work(LockstepServer& server, Nanoseconds wall);

 private:
  ros::Publisher publisher_;
  Nanoseconds due_ = 0;  // wall
};

}  // namespace move_base_abstract
