// The part of a session that is about parameters of ROS.
#include <algorithm>

#include "session.h"

namespace move_base_abstract {

namespace {

/** @throws MessageRouter::BadAction unless it says what is set, and to what. */
void check(const std::string& by, const wire::Parameter& item) {
  if (item.name.empty() || item.name.front() != '/' || item.is_set == item.value.empty()) {
    throw MessageRouter::BadAction(
        quote(by) +
        ": PARAMETER must have an absolute name, and a value where it is set, got name " +
        quote(item.name) + " and a value of " + std::to_string(item.value.size()) + " bytes");
  }
}

}  // namespace

void LockstepSession::applyParameter(const Member& member, const wire::Parameter& item) {
  check(member.name, item);
  parameters_.change(member.name, item);
}

/** @throws wire::MalformedFrame if what @p turn sets is no parameter. */
void LockstepSession::checkSets(const Member& member, const PendingTurn& turn) {
  try {
    for (const wire::ReportItem& item : turn.items) {
      if (const auto* set = std::get_if<wire::Parameter>(&item)) {
        check(member.name, *set);
      }
    }
  } catch (const MessageRouter::BadAction& error) {
    throw wire::MalformedFrame(error.what());
  }
}

/**
 * @brief What was set before the first round is there in every run, for all that is known. Who is
 * told to end sets at once: that says something of the run only if it goes on.
 */
void LockstepSession::parameterChangedOutside(const std::string& name) {
  // Nodes that are told to end take their parameters back: when all have gone, that says nothing.
  const bool anybody = std::any_of(members_.begin(), members_.end(),
                                   [](const auto& entry) { return !entry.second.departing; });
  if (!rounds_.started() || rounds_.ended() || !anybody) {
    return;
  }
  const std::string why = parameters_.changedOutside(name);
  if (!why.empty() && interruption_.isActive()) {
    interruption_.keep({Interruption::Label::Kind::kInput, 0, why});
  } else {
    labelIf(why);
  }
}

/** @brief Who has asked for what has changed is to be told so with its next grant. */
void LockstepSession::noteChanged() {
  for (const std::string& name : parameters_.concerned()) {
    for (auto& [id, member] : members_) {
      member.has_changed = member.has_changed || member.name == name;
    }
  }
}

void LockstepSession::parameterNotTaken(const ParameterChange& change) {
  labelIf("the ROS master has not taken parameter " + change.name + " of " + change.by);
}

void LockstepSession::labelIf(const std::string& why) {
  if (!why.empty()) {
    labels_.addNotRepeatable(why);
    poll_due_ = true;  // the run may be one that ends with its first label
  }
}

}  // namespace move_base_abstract
