#include "stored_topics.h"

#include <algorithm>
#include <stdexcept>

#include "clock/shown_text.h"

namespace move_base_abstract {
namespace {

bool isLetter(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z');
}

bool isPart(char letter) {
  return isLetter(letter) || letter == '_' || letter == '/' || (letter >= '0' && letter <= '9');
}

/** @return the name below the root; '' if it is not a valid name. */
std::string resolved(const std::string& name) {
  const std::string full = name.rfind('/', 0) == 0 ? name : '/' + name;
  const bool is_name = full.size() > 1 && isLetter(full[1]) && full.back() != '/' &&
                       full.find("//") == std::string::npos &&
                       std::all_of(full.begin(), full.end(), &isPart);
  return is_name ? full : "";
}

}  // namespace

std::vector<std::string> checkedStoredTopics(const std::vector<std::string>& entries) {
  std::vector<std::string> checked;
  for (const std::string& entry : entries) {
    const std::size_t equals = entry.find('=');
    const bool has_node = equals != std::string::npos;
    const std::string topic = resolved(has_node ? entry.substr(equals + 1) : entry);
    const std::string node = has_node ? resolved(entry.substr(0, equals)) : "";
    if (topic.empty() || (has_node && node.empty())) {
      throw std::invalid_argument(
          "stored_topics must be a list of TOPIC or NODE=TOPIC, such as [/positions, "
          "/agent=/map], got '" +
          shown(entry) + "'");
    }
    checked.push_back(has_node ? node + '=' + topic : topic);
  }
  return checked;
}

}  // namespace move_base_abstract
