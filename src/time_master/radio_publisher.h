// Tells onlookers how the links of a radio are: a topic, at changes.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_RADIO_PUBLISHER_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_RADIO_PUBLISHER_H

#include <ros/publisher.h>

#include "clock/scaled_clock.h"
#include "lockstep_server.h"

namespace move_base_abstract {

/** @brief The latched topic /time_master/links: there is none in a run without a radio. */
class RadioPublisher {
 public:
  /** @brief Publish, if something has changed and the last message is old enough. @p wall is an
   * instant of the wall clock [ns]. */
  void work(LockstepServer& server, Nanoseconds wall);

 private:
  ros::Publisher publisher_;
  Nanoseconds due_ = 0;  // wall
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_RADIO_PUBLISHER_H
