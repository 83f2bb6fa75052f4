#include "parameters.h"

#include <algorithm>
#include <utility>

#include "clock/number_text.h"

namespace move_base_abstract {
namespace {

/** @return the name as it is kept: without a slash at its end, and '' for all parameters. */
std::string_view trimmed(std::string_view name) {
  while (!name.empty() && name.back() == '/') {
    name.remove_suffix(1);
  }
  return name;
}

bool isBelow(std::string_view name, std::string_view above) {
  return name.substr(0, above.size()) == above &&
         (name.size() == above.size() || name[above.size()] == '/');
}

bool concerns(std::string_view one, std::string_view other) {
  return isBelow(one, other) || isBelow(other, one);
}

std::string label(std::string_view name, std::string_view by) {
  return "parameter " + std::string(name.empty() ? "/" : name) +
         " was set or deleted by a program that does not take part, and " + std::string(by) +
         " asks for it";
}

}  // namespace

std::string faultOf(std::string_view by, const wire::Parameter& item) {
  if (!item.name.empty() && item.name.front() == '/' && item.is_set != item.value.empty()) {
    return "";
  }
  return quote(by) + ": PARAMETER must have an absolute name, and a value if it is set, got name " +
         quote(item.name) + " and a value of " + std::to_string(item.value.size()) + " bytes";
}

void ParameterBook::change(std::string_view by, const wire::Parameter& item) {
  changes_.push_back(
      {std::string(by), std::string(item.name), std::string(item.is_set ? item.value : "")});
  changed_.emplace(trimmed(item.name));
}

std::set<std::string> ParameterBook::concerned() {
  std::set<std::string> names;
  const std::set<std::string> changed = std::exchange(changed_, {});
  const auto has_changed = [&changed](const std::string& asked) {
    return std::any_of(changed.begin(), changed.end(),
                       [&asked](const auto& name) { return concerns(name, asked); });
  };
  if (changed.empty()) {
    return names;
  }
  for (const auto& [name, asked] : askers_) {
    if (std::any_of(asked.begin(), asked.end(), has_changed)) {
      names.insert(name);
    }
  }
  return names;
}

std::vector<ParameterChange> ParameterBook::take() { return std::exchange(changes_, {}); }

std::string ParameterBook::asks(std::string_view by, std::string_view name) {
  name = trimmed(name);
  askers_[std::string(by)].emplace(name);
  if (!asked_.try_emplace(std::string(name), by).second) {
    return "";
  }
  const auto found = std::find_if(outside_.begin(), outside_.end(),
                                  [&](const auto& set) { return concerns(set, name); });
  return found == outside_.end() ? "" : label(*found, by);
}

std::string ParameterBook::changedOutside(std::string_view name) {
  name = trimmed(name);
  changed_.emplace(name);
  if (!outside_.emplace(name).second) {
    return "";
  }
  const auto found = std::find_if(asked_.begin(), asked_.end(),
                                  [&](const auto& asked) { return concerns(name, asked.first); });
  return found == asked_.end() ? "" : label(name, found->second);
}

}  // namespace move_base_abstract
