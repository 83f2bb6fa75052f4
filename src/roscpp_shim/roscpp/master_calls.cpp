// Calls to the ROS master and look-ups of host names. They take wall time, while simulated time
// stands still. Questions about nodes, topics and services are asked when no participant has
// anything left to do at the instant. So all that one launch file starts is there, however slow it
// was, and the answer is in the order of the names' bytes, in whichever order nodes registered.
#include <XmlRpc.h>
#include <netdb.h>
#include <ros/master.h>
#include <ros/this_node.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>

#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/node.h"
#include "roscpp_shim/parameters.h"
#include "roscpp_shim/registrations.h"
#include "roscpp_shim/turn.h"
#include "roscpp_shim/waits.h"

namespace {

/** @brief Marks a call during which time stands still. The thread keeps the turn, so that no other
 * thread of the program runs meanwhile. */
class Standing {
 public:
  Standing() : has_turn_(shim::turn().holds()) {}

 private:
  [[maybe_unused]] bool has_turn_;  // holds() gets it back if the thread ran beside the others
  shim::Blocking blocking_;
};

const std::array<const char*, 5> kQuestions = {"getPublishedTopics", "getTopicTypes",
                                               "getSystemState", "lookupNode", "lookupService"};
/** After this many questions in a row, they count as a loop that waits by asking. */
constexpr unsigned kAsked = 100;

/** @return whether one of the program's threads calls, and has the turn. */
bool isOfProgram() {
  return !shim::Turn::isInside() && !shim::Turn::isInternal() && shim::turn().enter();
}

/** @brief Wait until no participant has anything left to do; in a loop of questions time goes on.
 */
void awaitOthers() {
  shim::countRepeated(&shim::Turn::self()->questions, kAsked, shim::kPassage, "the ROS master");
  shim::Wait wait;
  wait.at_rest = true;
  shim::turn().wait(wait);
}

/** @brief Wait for the next round. So if two nodes ask at once, neither sees what the other does
 * with its answer. */
void awaitNextRound() {
  shim::Wait wait;
  wait.next_round = true;
  shim::turn().wait(wait);
}

/** @brief Answers a question about nodes, topics and services, after all others have done their
 * work of this instant. */
class Question {
 public:
  Question(const XmlRpc::XmlRpcValue& request, const shim::AskMaster& ask)
      : request_(request), ask_(ask) {}

  /** @return whether the call of @p method succeeds. */
  bool answer(const std::string& method, XmlRpc::XmlRpcValue& answer) {
    awaitOthers();
    const bool is_good = ask(method, answer);
    if (shim::turn().enter()) {
      awaitNextRound();
    }
    return is_good;
  }

 private:
  bool ask(const std::string& method, XmlRpc::XmlRpcValue& answer) {
    auto& membership = shim::node().membership();
    const std::set<std::string> gone = membership.gone();
    if (method == "lookupNode" && gone.count(request_[1]) > 0) {
      return false;
    }
    XmlRpc::XmlRpcValue state, request;
    request[0] = request_[0];
    if (ask_(method, request_, answer) != shim::Asked::kGood ||
        ask_("getSystemState", request, state) != shim::Asked::kGood) {
      return false;
    }
    const shim::Registrations there(state, membership.present(), gone);
    if (method == "getSystemState") {
      answer = there.state();
      tell(there.strangers());
    } else if (method == "lookupNode") {
      const std::string node = request_[1];
      tell(there.isStranger(node) ? std::set<std::string>{node} : std::set<std::string>{});
    } else if (method != "lookupService") {
      answer = there.topics(answer, method == "getTopicTypes");
      tell(there.strangers(answer));
    }
    return true;
  }

  static void tell(const std::set<std::string>& strangers) {
    for (const std::string& node : strangers) {
      shim::node().label(
          "it has asked the ROS master for nodes, topics or services: " + node +
          " does not take part, so it depends on the wall clock whether it is there");
    }
  }

  const XmlRpc::XmlRpcValue& request_;
  const shim::AskMaster& ask_;
};

}  // namespace

namespace ros::master {

bool execute(const std::string& method, const XmlRpc::XmlRpcValue& request,
             XmlRpc::XmlRpcValue& response, XmlRpc::XmlRpcValue& payload, bool wait_for_master) {
  static auto* const function = shim::real(&execute, "ros::master::execute");
  const bool is_question =
      std::find(kQuestions.begin(), kQuestions.end(), method) != kQuestions.end();
  if ((!is_question && !shim::Parameters::isAbout(method)) || !isOfProgram()) {
    const Standing standing;
    return function(method, request, response, payload, wait_for_master);
  }
  const shim::AskMaster ask = [&](const std::string& other, const XmlRpc::XmlRpcValue& question,
                                  XmlRpc::XmlRpcValue& answer) {
    XmlRpc::XmlRpcValue whole;
    const Standing standing;
    const bool is_good = function(other, question, whole, answer, wait_for_master);
    // A fault is a struct, and without an answer there is nothing.
    const bool is_answer = whole.getType() == XmlRpc::XmlRpcValue::TypeArray;
    return is_good     ? shim::Asked::kGood
           : is_answer ? shim::Asked::kRefused
                       : shim::Asked::kNotAnswered;
  };
  const bool is_good = is_question ? Question(request, ask).answer(method, payload)
                                   : shim::parameters().answer(method, request, payload, ask);
  if (!is_good) {
    payload.clear();  // as roscpp leaves it
  }
  response.clear();
  response[0] = is_good ? 1 : -1;
  response[1] = method;
  response[2] = is_good ? payload : XmlRpc::XmlRpcValue(0);
  return is_good;
}

}  // namespace ros::master

namespace XmlRpc {

bool XmlRpcClient::execute(const char* method, const XmlRpcValue& parameters, XmlRpcValue& result) {
  static auto* const function = shim::real(&XmlRpcClient::execute, "XmlRpc::XmlRpcClient::execute");
  const Standing standing;
  return function(this, method, parameters, result);
}

}  // namespace XmlRpc

#pragma GCC visibility push(default)
extern "C" {

int getaddrinfo(const char* node, const char* service, const addrinfo* hints, addrinfo** result) {
  static auto* const function = shim::real(&::getaddrinfo, "getaddrinfo");
  const Standing standing;
  return function(node, service, hints, result);
}

hostent* gethostbyname(const char* name) {
  static auto* const function = shim::real(&::gethostbyname, "gethostbyname");
  const Standing standing;
  return function(name);
}

}  // extern "C"
#pragma GCC visibility pop
