// A service whose handler sleeps, and its client. With ~serve it offers /wait, which takes 0.5 s
// and refuses `false`. Otherwise it calls /wait with each of ~calls, prints "TIME_NS ANSWER", and
// leaves.
#include <move_base_abstract/lockstep_participant.h>
#include <ros/ros.h>
#include <std_srvs/SetBool.h>

#include <cstdio>
#include <stdexcept>
#include <vector>

namespace lockstep_service {

namespace lockstep = move_base_abstract::lockstep;

namespace {

void serve(lockstep::Participant& participant) {
  const auto server = participant.advertiseService<std_srvs::SetBool>(
      "/wait", [&](std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
        participant.sleep(ros::Duration(0.5));
        response.success = true;
        response.message = "waited";
        return static_cast<bool>(request.data);
      });
  participant.spin();
}

void use(lockstep::Participant& participant, const std::vector<bool>& calls) {
  const auto tell = [&](const char* what) {
    std::printf("%llu %s\n", static_cast<unsigned long long>(participant.now().toNSec()), what);
  };
  tell(participant.waitForService("/nobody", ros::Duration(0.25)) ? "found" : "nobody");
  participant.waitForService("/wait");
  for (const bool data : calls) {
    std_srvs::SetBool call;
    call.request.data = data;
    tell(participant.call("/wait", call) ? call.response.message.c_str() : "failed");
  }
  std_srvs::SetBool call;
  tell(participant.call("/nobody", call) ? "answered" : "failed");
  participant.leave("done");
}

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "lockstep_service");
  const ros::NodeHandle node("~");
  lockstep::Participant participant;
  if (node.param("serve", false)) {
    serve(participant);
  } else {
    use(participant, node.param("calls", std::vector<bool>{true, false, true}));
  }
  return 0;
}

}  // namespace lockstep_service
