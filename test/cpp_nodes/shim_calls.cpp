// Services. The server answers, after a sleep of ~work [s] if that is set. With ~client it waits
// for services with and without success, calls once a second, and publishes what it sees on
// "answers". With ~at_once it calls without waiting first, until there is an answer.
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <stdexcept>
#include <string>

#include "teller.h"

namespace shim_calls {

namespace {

double work = 0;

bool onTrigger(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  if (work > 0) {
    ros::Duration(work).sleep();
  }
  response.success = true;
  response.message = "at " + std::to_string(ros::Time::now().toNSec());
  return true;
}

bool onRefuse(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response&) {
  if (request.data != 0) {
    throw std::runtime_error("");  // an exception without a text is one, too
  }
  return false;
}

void callAtOnce(ros::NodeHandle& node) {
  const Teller teller("answers");
  std_srvs::Trigger trigger;
  ros::ServiceClient client = node.serviceClient<std_srvs::Trigger>("trigger");
  while (!client.call(trigger)) {
    ros::Duration(0.5).sleep();
  }
  teller.tell(trigger.response.message);
}

void runClient(ros::NodeHandle& node) {
  const Teller teller("answers");
  teller.tell(ros::service::waitForService("nobody", ros::Duration(2.0)) ? "found" : "not found");
  if (ros::NodeHandle("~").param("hears", false)) {
    ros::topic::waitForMessage<std_msgs::String>("silence", ros::Duration(0.5));
  }
  teller.tell(ros::service::waitForService("trigger") ? "found" : "not found");
  ros::ServiceClient client = node.serviceClient<std_srvs::Trigger>("trigger");
  ros::Rate rate(1);
  for (int k = 0; k < 20 && ros::ok(); ++k) {
    std_srvs::Trigger trigger;
    teller.tell(client.call(trigger) ? trigger.response.message : "failed");
    rate.sleep();
  }
  std_srvs::SetBool refuse;
  teller.tell(ros::service::call("refuse", refuse) ? "not refused" : "refused");
  ros::NodeHandle("~").setParam("done", true);
}

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "calls");
  ros::NodeHandle node;
  ros::NodeHandle("~").param("work", work, work);
  if (ros::NodeHandle("~").param("at_once", false)) {
    callAtOnce(node);
    return 0;
  }
  if (ros::NodeHandle("~").param("client", false)) {
    runClient(node);
    return 0;
  }
  const ros::ServiceServer trigger = node.advertiseService("trigger", &onTrigger);
  const ros::ServiceServer refuse = node.advertiseService("refuse", &onRefuse);
  ros::spin();
  return 0;
}

}  // namespace shim_calls
