#include "debugger_services.h"

#include <stdexcept>
#include <utility>

#include "clock/shown_text.h"
#include "time_mode.h"

namespace move_base_abstract {
namespace {

/** @throws std::invalid_argument if the request has another number for `what`. */
StopCondition toCondition(const StopWhen::Request& request) {
  if (request.what != StopWhen::Request::ROUND && request.what != StopWhen::Request::ROW) {
    throw std::invalid_argument("stop_when: what must be 0 (ROUND) or 1 (ROW), got " +
                                std::to_string(request.what));
  }
  StopCondition condition;
  condition.what = request.what == StopWhen::Request::ROW ? StopCondition::What::kRow
                                                          : StopCondition::What::kRound;
  condition.kind = request.kind;
  condition.robot = request.robot;
  condition.topic = request.topic;
  condition.count = request.count;
  condition.row = request.row;
  condition.until = fromRos(request.until);
  return condition;
}

KeptMessage toRosMessage(const KeptMessages::One& kept) {
  KeptMessage message;
  message.time = toRos(kept.time);
  message.kind = kept.kind;
  message.topic = kept.name;
  message.type = kept.type;
  message.md5sum = kept.md5;
  message.sender = kept.sender;
  message.receivers = kept.receivers;
  message.bytes.assign(kept.bytes.begin(), kept.bytes.end());
  return message;
}

}  // namespace

DebuggerServices::DebuggerServices(ros::NodeHandle& own, std::function<LockstepServer*()> server,
                                   std::function<void()> changed)
    : server_(std::move(server)), changed_(std::move(changed)) {
  services_ = {own.advertiseService("stop_when", &DebuggerServices::onStopWhen, this),
               own.advertiseService("recent", &DebuggerServices::onRecent, this),
               own.advertiseService("looking", &DebuggerServices::onLooking, this)};
}

/**
 * @brief Answer with the text that @p action returns for the session, or with its refusal.
 * @param instead what to do on the scaled clock.
 */
template <typename Response, typename Action>
bool DebuggerServices::answer(const char* service, const char* instead, Response& response,
                              Action action) {
  try {
    LockstepServer* const server = server_();
    if (server == nullptr) {
      throw std::invalid_argument(
          std::string(service) +
          ": only in lockstep. On the scaled clock nodes go on by themselves: " + instead +
          ", or start the launch file by `rosrun move_base_abstract debug`");
    }
    response.message = server->with(action);
    response.success = true;
    changed_();
  } catch (const std::invalid_argument& error) {
    response.message = error.what();
    response.success = false;
    ROS_WARN("service %s refused: %s", service, shown(error.what()).c_str());
  }
  return true;
}

bool DebuggerServices::onStopWhen(StopWhen::Request& request, StopWhen::Response& response) {
  return answer("stop_when", "use pause, step or run_until", response,
                [&](LockstepSession& session) {
                  response.stop = session.stopWhen(toCondition(request));
                  return "running until stop " + std::to_string(response.stop);
                });
}

bool DebuggerServices::onRecent(RecentMessages::Request& request,
                                RecentMessages::Response& response) {
  return answer(
      "recent", "use rostopic echo or rosbag record", response, [&](LockstepSession& session) {
        for (const auto& kept : session.recent(request.topic, request.node, request.count)) {
          response.messages.push_back(toRosMessage(kept));
        }
        return std::to_string(response.messages.size()) + " messages";
      });
}

bool DebuggerServices::onLooking(SetLooking::Request& request, SetLooking::Response& response) {
  return answer(
      "looking", "attach a debugger to the node, time does not wait for it", response,
      [&](LockstepSession& session) {
        session.look(request.node, request.is_looking);
        return std::string(request.is_looking ? "somebody looks at " : "nobody looks at ") +
               request.node;
      });
}

}  // namespace move_base_abstract
