// What was decided, as JSON. No ROS.
#include "chaos_parameters.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "clock/json_text.h"
#include "clock/number_text.h"

namespace move_base_abstract {

std::string chaosHead(const LockstepSettings& settings) {
  if (settings.chaos_seed == 0) {
    return "";
  }
  return "\"chaos\":{\"seed\":" + std::to_string(settings.chaos_seed) +
         ",\"delay\":" + numberText(settings.chaos_delay) +
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
  const std::string part = path + ".part";
  std::FILE* const file = std::fopen(part.c_str(), "wxe");
  bool good = file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  good = (file == nullptr || std::fclose(file) == 0) && good;
  if (!good || std::rename(part.c_str(), path.c_str()) != 0) {
    return "chaos_decisions " + path + ": " + std::strerror(errno);
  }
  return "";
}

}  // namespace move_base_abstract
