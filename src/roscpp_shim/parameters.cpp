#include "parameters.h"

#include <ros/common.h>
#include <ros/init.h>
#include <ros/names.h>
#include <ros/param.h>

#include <algorithm>
#include <array>
#include <utility>

#include "clock/number_text.h"
#include "lockstep/wire/utf8.h"
#include "node.h"
#include "roscpp_shim/machine/real.h"
#include "turn.h"
#include "waits.h"

namespace move_base_abstract::shim {
namespace {

using XmlRpc::XmlRpcValue;

const std::array<const char*, 7> kMethods = {"setParam",      "deleteParam", "getParam",
                                             "hasParam",      "searchParam", "getParamNames",
                                             "subscribeParam"};
/** Parameters that roslaunch sets about itself; their names contain ports of this machine. */
constexpr const char* kOfRoslaunch = "/roslaunch/uris/";
/** After kLooks looks at one parameter, with at most kPassage of simulated time between two, they
 * count as a loop that waits for it. */
constexpr unsigned kLooks = 100;
/** roscpp looks at this parameter for each line that the program logs, and does not wait for it.
 * But a loop that waits for something else may log, so kLines lines of one instant take kPassage.
 */
constexpr const char* kOfLogging = "/rosout_disable_topics_generation";
constexpr unsigned kLines = 1000;

XmlRpcValue requestOf(const XmlRpcValue& request, const std::string& name) {
  XmlRpcValue made;
  made[0] = request[0];
  made[1] = name;
  return made;
}

/** @return whether @p text is allowed in XML 1.0, where xmlrpcpp puts it unchanged. */
bool canStand(const std::string& text) {
  const auto is_control = [](char letter) {
    return static_cast<unsigned char>(letter) < ' ' && letter != '\t' && letter != '\n' &&
           letter != '\r';
  };
  return isUtf8(text) && std::none_of(text.begin(), text.end(), is_control);
}

/**
 * @return @p value as XML-RPC; empty if XML-RPC cannot express it: it, or a part of it, has no
 * type, or a text in it is not UTF-8 or has control characters.
 */
std::string parameterText(const XmlRpcValue& value) {
  const std::string text = value.toXml();
  int offset = 0;
  const bool is_whole = canStand(text) && XmlRpcValue(text, &offset).valid();
  return is_whole ? text : "";
}

}  // namespace

Parameters& parameters() {
  static Parameters* const instance = new Parameters;  // threads use it until the process has gone
  return *instance;
}

bool Parameters::isAbout(const std::string& method) {
  return std::find(kMethods.begin(), kMethods.end(), method) != kMethods.end();
}

bool Parameters::answer(const std::string& method, const XmlRpcValue& request, XmlRpcValue& answer,
                        const AskMaster& ask) {
  Turn::self()->has_acted = true;  // so a loop around it does more than look at its queue
  if (method == "getParamNames") {
    return names(request, answer, ask);
  }
  if (method == "searchParam") {
    return search(request, answer, ask);
  }
  const std::string key = request[method == "subscribeParam" ? 2 : 1];
  const std::string name = ros::names::resolve(key, false);
  answer = 0;
  if (!ros::ok() && method != "getParam" && method != "hasParam") {
    return ask(method, request, answer) == Asked::kGood;  // there may be no more rounds
  }
  if (method == "setParam") {
    const std::string text = parameterText(request[2]);
    if (text.empty()) {
      return ask(method, request, answer) == Asked::kGood;  // refused
    }
    pending_.set(name, request[2]);
    node().append(wire::Parameter{name, true, text});
    return true;
  }
  if (method == "deleteParam") {
    if (!isSet(name, request, ask)) {
      return false;
    }
    pending_.erase(name);
    node().append(wire::Parameter{name, false, ""});
    return true;
  }
  look(name);
  if (method == "hasParam") {
    answer = isSet(name, request, ask);
    return true;
  }
  tellOfRoslaunch(name);
  return get(name, request, answer, ask);  // no notices of changes, which come by the wall clock
}

/** @brief Count a look at a parameter. A loop that waits by looking at it lets time go on. */
void Parameters::look(const std::string& name) {
  const bool is_logging = name == kOfLogging;
  Repeated& look = looks_[name];
  if (countRepeated(&look, is_logging ? kLines : kLooks, is_logging ? 0 : kPassage,
                    "a parameter") &&
      is_logging) {
    look.count = 1;  // this line is the first one of the new instant
  }
}

void Parameters::tellOfRoslaunch(const std::string& name) {
  const bool is_roslaunchs =
      name == "/" || name == "/run_id" || (name + "/").rfind("/roslaunch/", 0) == 0;
  if (is_roslaunchs && told_.insert(name).second) {
    node().label("getParam() of " + name + ": roslaunch sets another one in each run");
  }
}

bool Parameters::get(const std::string& name, const XmlRpcValue& request, XmlRpcValue& answer,
                     const AskMaster& ask) {
  const bool is_there = askMaster("getParam", name, request, answer, ask);
  if (!pending_.concern(name)) {
    return is_there;
  }
  answer = pending_.seen(name, is_there ? answer : XmlRpcValue());
  return answer.valid();
}

bool Parameters::isSet(const std::string& name, const XmlRpcValue& request, const AskMaster& ask) {
  XmlRpcValue answer;
  if (pending_.concern(name)) {
    return get(name, request, answer, ask);
  }
  return askMaster("hasParam", name, request, answer, ask) &&
         answer.getType() == XmlRpcValue::TypeBoolean && static_cast<bool>(answer);
}

/** @brief Search from the namespace upwards, for the key's first word only, as rosmaster does. */
bool Parameters::search(const XmlRpcValue& request, XmlRpcValue& answer, const AskMaster& ask) {
  const std::string key = request[1];
  std::string why;
  if (key.empty() || key[0] == '~' || !ros::names::validate(key, why)) {
    return ask("searchParam", request, answer) == Asked::kGood;  // refused
  }
  std::string space = key[0] == '/' ? "" : static_cast<std::string>(request[0]);
  while (!space.empty() && space.back() == '/') {
    space.pop_back();
  }
  const std::string first = key.substr(0, key.find('/', 1));
  while (true) {
    const std::string sought = key[0] == '/' ? key : space + "/" + first;
    if (isSet(sought, request, ask)) {
      answer = key[0] == '/' ? key : space + "/" + key;
      return true;
    }
    if (space.empty()) {
      return false;
    }
    space.erase(space.rfind('/'));
  }
}

bool Parameters::names(const XmlRpcValue& request, XmlRpcValue& answer, const AskMaster& ask) {
  note("/");
  if (ask("getParamNames", request, answer) != Asked::kGood ||
      answer.getType() != XmlRpcValue::TypeArray) {
    return false;
  }
  std::vector<std::string> found;
  for (int k = 0; k < answer.size(); ++k) {
    found.push_back(answer[k]);
  }
  found = pending_.names(found);
  found.erase(std::remove_if(found.begin(), found.end(),
                             [](const auto& name) { return name.rfind(kOfRoslaunch, 0) == 0; }),
              found.end());
  std::sort(found.begin(), found.end());
  answer.clear();
  answer.setSize(0);
  for (std::size_t k = 0; k < found.size(); ++k) {
    answer[static_cast<int>(k)] = found[k];
  }
  return true;
}

void Parameters::reported() {
  if (!pending_.empty()) {
    kept_.clear();
    pending_.clear();
  }
}

void Parameters::settle() {
  keepNoAnswers();
  if (!Turn::isInside() && !Turn::isInternal() && turn().enter() && !pending_.empty()) {
    Wait wait;
    wait.next_round = true;
    turn().wait(std::move(wait));
  }
}

/** @brief Ask the ROS master for a parameter, or repeat its answer if nothing has changed it. */
bool Parameters::askMaster(const char* method, const std::string& name, const XmlRpcValue& request,
                           XmlRpcValue& answer, const AskMaster& ask) {
  note(name);
  const std::uint64_t changes = node().membership().parameterChanges();
  if (std::exchange(changes_, changes) != changes || !keeps_) {
    kept_.clear();
  }
  const auto key = std::make_pair(std::string(method), name);
  auto kept = kept_.find(key);
  if (kept == kept_.end()) {
    const Asked asked = ask(method, requestOf(request, name), answer);
    if (asked == Asked::kNotAnswered) {
      return false;
    }
    kept = kept_.insert({key, {asked == Asked::kGood, answer}}).first;
  }
  answer = kept->second.answer;
  return kept->second.is_good;
}

/** @brief Report that the program reads @p name. If a node that takes no part sets it, that labels
 * the run. */
void Parameters::note(const std::string& name) {
  if (asked_.insert(name).second) {
    node().append(wire::Asks{name});
  }
}

void tellInVain(const std::string& what) {
  std::vector<std::string> others;
  ros::param::get("/time_master/onlookers", others);
  if (!others.empty()) {
    node().label(what +
                 " was waited for in vain; it may be of a node that looks on: " + joined(others));
  }
}

}  // namespace move_base_abstract::shim

namespace ros::param {

/** Without roscpp's cache: the ROS master's notices of changes come by the wall clock. */
ROSCPP_DECL bool getImpl(const std::string& key, XmlRpc::XmlRpcValue& value, bool use_cache) {
  static auto* const function =
      shim::real<bool(const std::string&, XmlRpc::XmlRpcValue&, bool)>("ros::param::getImpl");
  return function(key, value, use_cache && !shim::takesPart());
}

}  // namespace ros::param
