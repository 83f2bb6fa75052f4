#include "welcome.h"

#include <cstddef>
#include <iterator>

namespace move_base_abstract {
namespace {

constexpr std::size_t kTimeDigits = 13;  // of the wall time in ms; in ns it has more

/**
 * @brief ROS's own topics: the clock, which the grants replace, and topics for people to look at.
 */
constexpr const char* kNeverCounted[] = {"/clock", "/rosout", "/rosout_agg", "/statistics"};

std::string resolved(const std::string& topic, std::string_view node) {
  if (topic[0] == '/') {
    return topic;
  }
  if (topic[0] == '~') {
    return std::string(node) + '/' + topic.substr(1);
  }
  return std::string(node.substr(0, node.rfind('/') + 1)) + topic;
}

}  // namespace

bool isAnonymous(std::string_view name) {
  const std::size_t before = name.find_last_not_of("0123456789");
  return before != std::string_view::npos && name[before] == '_' &&
         name.size() - before - 1 >= kTimeDigits;
}

std::vector<std::string> excludedTopics(const LockstepSettings& settings, std::string_view node) {
  std::vector<std::string> topics(std::begin(kNeverCounted), std::end(kNeverCounted));
  for (const std::string& topic : settings.excluded_topics) {
    topics.push_back(resolved(topic, node));
  }
  return topics;
}

std::string encodeWelcome(MemberId id, const wire::Hello& hello, const LockstepSettings& settings) {
  const std::vector<std::string> excluded = excludedTopics(settings, hello.name);
  wire::Welcome welcome;
  welcome.own_id = id;
  welcome.rank = rankOf(hello);
  welcome.leave_limit_ns = kLastWordsLimit;
  // Early enough that the text is known when the silence is reported.
  welcome.busy_limit_ns =
      settings.silence_limit > 0.0 ? toNanoseconds(settings.silence_limit) / 5 * 4 : kNever;
  welcome.excluded_topics.assign(excluded.begin(), excluded.end());
  welcome.radio = !settings.network.empty();
  return wire::encode(wire::MasterFrame(welcome));
}

}  // namespace move_base_abstract
