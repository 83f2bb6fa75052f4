#include "labels.h"

#include <algorithm>
#include <cstddef>

#include "clock/shown_text.h"

namespace move_base_abstract {
namespace {

constexpr std::size_t kMostLabels = 100;  // of a kind

/** @brief Add a label that is not there yet. @return the label to report; '' if there is none. */
std::string addLabel(std::vector<std::string>& labels, const std::string& text) {
  const std::string label =
      labels.size() < kMostLabels ? shown(text) : "and more; only the first are listed";
  if (std::find(labels.begin(), labels.end(), label) != labels.end()) {
    return "";
  }
  labels.push_back(label);
  return label;
}

}  // namespace

void RunLabels::addNotRepeatable(const std::string& why) {
  const std::string added = addLabel(not_repeatable_, why);
  if (!added.empty()) {
    messages_.say(LockstepMessage::Level::kInfo, "the run is not repeatable: " + added);
    first_ = first_.empty() ? "not repeatable: " + added : first_;
  }
}

void RunLabels::addDegraded(const std::string& why) {
  const std::string added = addLabel(degraded_, why);
  // A run that is degraded may be repeatable, and its log has these labels: the wall clock says
  // which of two nodes that crash at one instant is noticed first.
  std::sort(degraded_.begin(), degraded_.end());
  if (!added.empty()) {
    messages_.say(LockstepMessage::Level::kWarn, "the run is degraded: " + added);
    first_ = not_repeatable_.empty() ? "degraded: " + degraded_.front() : first_;
  }
}

}  // namespace move_base_abstract
