// Parameters of a participant. With ~count it sets and deletes some, ~count times, every 0.1 s;
// otherwise it looks at them. At the end it asks for the parameter ~asks and waits for the run's
// end.
#include <move_base_abstract/lockstep_participant.h>
#include <ros/ros.h>

#include <cstdio>
#include <functional>
#include <string>

namespace lockstep_board {

namespace lockstep = move_base_abstract::lockstep;

namespace {

using XmlRpc::XmlRpcValue;

/** Print what all participants see at this instant, after the earlier rounds. */
void look(const lockstep::Participant& participant) {
  std::string text = "-";
  const int count = ros::param::param("/wall/count", 0);
  ros::param::get("/wall/tree/odd", text);
  const double small = ros::param::param("/wall/tree/small", 0.0);
  std::printf("%llu %d %s %s\n", static_cast<unsigned long long>(participant.now().toNSec()), count,
              text.c_str(), small == -1e-12 * count ? "exact" : "not exact");
}

void refused(const std::function<void()>& call) {
  try {
    call();
    std::printf("taken\n");
  } catch (const std::exception& error) {
    std::printf("refused: %s\n", error.what());
  }
}

void tryWhatCannotBe(lockstep::Participant& participant) {
  refused([&] { participant.setParam("/wall/nothing", XmlRpcValue()); });
  XmlRpcValue hollow;
  hollow["within"] = XmlRpcValue();
  refused([&] { participant.setParam("/wall/nothing", hollow); });
  refused([&] { participant.setParam("/wall/odd", XmlRpcValue("\xff")); });
  refused([&] { participant.setParam("/wall/\xff", XmlRpcValue(1)); });
  refused([&] { participant.deleteParam("/wall/\xff"); });
  refused([&] { participant.asksForParam("/wall/\xff"); });
  refused([&] { participant.setParam("board?", XmlRpcValue(1)); });
}

void write(lockstep::Participant& participant, int count) {
  for (int k = 1; k <= count; ++k) {
    XmlRpcValue tree;
    tree["odd"] = std::string("<&> \xc3\xa4");
    tree["small"] = -1e-12 * k;
    participant.setParam("wall/count", XmlRpcValue(-1));
    participant.setParam("wall/count", XmlRpcValue(k));  // the last value counts
    participant.setParam("/wall/tree", tree);
    if (k % 3 == 0) {
      participant.deleteParam("/wall/tree/odd");
      participant.deleteParam("/wall/never_there");
    }
    look(participant);  // it does not see its own before the round is over
    participant.sleep(ros::Duration(0.1));
  }
}

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "board");
  const ros::NodeHandle node("~");
  lockstep::Participant participant;
  if (const int count = node.param("count", 0); count > 0) {
    tryWhatCannotBe(participant);
    write(participant, count);
  } else {
    for (int k = 0; k < node.param("looks", 0); ++k) {
      look(participant);
      participant.sleep(ros::Duration(0.1));
    }
  }
  if (const auto asks = node.param("asks", std::string()); !asks.empty()) {
    std::fflush(stdout);
    participant.asksForParam(asks);
    participant.setParam("/wall/has_asked", XmlRpcValue(true));
    while (participant.sleep(ros::Duration(1.0))) {
    }
  }
  return 0;
}

}  // namespace lockstep_board
