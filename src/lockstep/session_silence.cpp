// What is said of participants whose work on one grant takes long.
#include "clock/number_text.h"
#include "clock/shown_text.h"
#include "session.h"

namespace move_base_abstract {
namespace {

std::string also(const char* words, const std::string& what) {
  return what.empty() ? "" : words + what;
}

}  // namespace

void LockstepSession::handleSilence(const LockstepRounds::Event& event) {
  const LockstepRounds::MemberState* member = rounds_.find(event.member);
  if (!member) {
    return;
  }
  const std::string time = secondsText(event.duration) + " of wall time";
  if (event.kind == LockstepRounds::Event::Kind::kAnswered) {
    messages_.say(Level::kInfo, text_.quoted(event.member) + " answered after " + time);
    return;
  }
  Member& silent = members_.at(event.member);
  silent.silence_told = true;
  messages_.say(Level::kWarn, text_.quoted(event.member) + " has been silent for " + time +
                                  "; it owes " + text_.owed(*member) + text_.at() +
                                  also("; it was told last: ", text_.told(event.member, router_)) +
                                  also("; it is in ", silent.where));
  if (settings_.on_silence == OnSilence::kDrop) {
    const std::string reason = "it was dropped: silent for " + time;
    connections_.close(silent.connection, reason);
    die(event.member, reason);
  }
}

void LockstepSession::takeBusy(MemberId id, const wire::Busy& busy) {
  const LockstepRounds::MemberState* const state = rounds_.find(id);
  if (state == nullptr || !state->owes || state->round != busy.round) {
    return;  // it has reported meanwhile
  }
  Member& member = members_.at(id);
  member.where = shown(busy.where);
  if (member.silence_told) {
    messages_.say(Level::kWarn, text_.quoted(id) + " is in " + member.where);
  }
}

}  // namespace move_base_abstract
