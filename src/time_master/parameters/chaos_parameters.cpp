// The decisions of chaos as JSON. No ROS.
#include "chaos_parameters.h"

#include "clock/json_text.h"
#include "clock/number_text.h"
#include "time_master/new_file.h"

namespace move_base_abstract {

std::string chaosHead(const LockstepSettings& settings) {
  if (settings.chaos_seed == 0) {
    return "";
  }
  return "\"chaos\":{\"seed\":" + std::to_string(settings.chaos_seed) +
         ",\"delay\":" + numberText(settings.chaos_delay) +
         (settings.chaos_starts == 0.0 ? "" : ",\"starts\":" + numberText(settings.chaos_starts)) +
         (settings.chaos_only.empty() ? "" : ",\"some\":true") + "}";
}

std::string writeDecisions(const std::string& path, const std::vector<chaos::Decision>& decisions) {
  std::string text;
  for (const chaos::Decision& one : decisions) {
    text += "{\"name\":\"" + one.name + "\",\"time_ns\":" + std::to_string(one.time) +
            ",\"what\":\"" + one.what + "\",\"says\":";
    appendJson(text, one.says);
    text += "}\n";
  }
  return writeNewFile("chaos_decisions", path, text);
}

}  // namespace move_base_abstract
