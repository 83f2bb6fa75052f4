// Messages about participants whose work on one grant takes long.

#include "silence.h"

#include <string>

#include "clock/number_text.h"
#include "clock/shown_text.h"

namespace move_base_abstract {
namespace {

std::string also(const char* words, const std::string& what) {
  return what.empty() ? "" : words + what;
}

}  // namespace

void Silence::handle(const LockstepRounds::Event& event) {
  const MemberState* member = run_.rounds.members().find(event.member);
  if (!member) {
    return;
  }
  const std::string time = secondsText(event.duration) + " of wall time";
  if (event.kind == LockstepRounds::Event::Kind::kAnswered) {
    run_.messages.say(LockstepMessage::Level::kInfo,
                      run_.text.quoted(event.member) + " answered after " + time);
    return;
  }
  SessionMember& silent = run_.members.at(event.member);
  silent.silence_told = true;
  run_.messages.say(LockstepMessage::Level::kWarn,
                    run_.text.quoted(event.member) + " has been silent for " + time + "; it owes " +
                        run_.text.owed(*member) + run_.text.at() +
                        also("; it was told last: ", run_.text.told(event.member, run_.router)) +
                        also("; it is in ", silent.where));
  if (run_.settings.on_silence == OnSilence::kDrop) {
    const std::string reason = "it was dropped: silent for " + time;
    run_.connections.close(silent.connection, reason);
    departures_.die(event.member, reason);
  }
}

void Silence::takeBusy(MemberId id, const wire::Busy& busy) {
  const MemberState* const state = run_.rounds.members().find(id);
  if (state == nullptr || !state->owes || state->round != busy.round) {
    return;  // it has reported meanwhile
  }
  SessionMember& member = run_.members.at(id);
  member.where = shown(busy.where);
  if (member.silence_told) {
    run_.messages.say(LockstepMessage::Level::kWarn,
                      run_.text.quoted(id) + " is in " + member.where);
  }
}

}  // namespace move_base_abstract
