// The services that a participant offers.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_SERVICES_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_SERVICES_H

#include <ros/node_handle.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "outside.h"

namespace move_base_abstract::lockstep::internal {

class Core;

class Service {
 public:
  Service(const std::shared_ptr<Core>& core, std::uint32_t number, std::string name,
          ros::ServiceCallbackHelperPtr helper)
      : core_(core), number_(number), name_(std::move(name)), helper_(std::move(helper)) {}
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /** @brief Call the handler, and append the answer to the next report. */
  void answer(std::uint32_t caller, std::uint32_t number, const std::string& caller_name,
              std::string_view request);
  void listenOutside(ros::NodeHandle& node, const std::shared_ptr<OutsideQueue>& queue,
                     ros::AdvertiseServiceOptions options);

 private:
  std::weak_ptr<Core> core_;
  std::uint32_t number_;
  std::string name_;
  ros::ServiceCallbackHelperPtr helper_;
  std::shared_ptr<OutsideQueue> queue_;
  ros::ServiceServer outside_;
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_SERVICES_H
