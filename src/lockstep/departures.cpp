// How a participant leaves: by itself, because its process died, or because a signal told it to
// end.
#include "departures.h"

#include <algorithm>
#include <cstddef>

namespace move_base_abstract {
namespace {

constexpr std::size_t kMostDepartures = 1000;  // in the list

}  // namespace

void Departures::toldToEnd(MemberId id, const wire::Stopping& stopping) {
  if (!run_.rounds.started() || run_.interruption.concerns(id)) {
    return;
  }
  run_.messages.say(LockstepMessage::Level::kInfo,
                    run_.text.quoted(id) + " is told to end (" + std::string(stopping.reason) +
                        ")" + run_.text.at() +
                        ": time stands until it is clear whether others go on");
  beginInterruption(id);
}

void Departures::beginInterruption(MemberId id) {
  run_.interruption.begin(id, run_.members.at(id).connection, run_.wall, run_.rounds.atRest());
}

void Departures::leave(MemberId id, const wire::Leave& leave) {
  if (run_.rounds.started()) {
    beginInterruption(id);
    keepLeft(id);
  }
  depart(id, "left" + (leave.reason.empty() ? "" : " (" + std::string(leave.reason) + ")"));
}

void Departures::reportedLast(MemberId id) {
  if (run_.interruption.concerns(id)) {
    keepLeft(id);
  }
  depart(id, "left");
}

void Departures::keepLeft(MemberId id) {
  run_.interruption.keep(
      {Interruption::Label::Kind::kLeft, id,
       run_.text.quoted(id) + " left" + run_.text.at() + ", when the wall clock said so"});
}

void Departures::depart(MemberId id, const std::string& how) {
  SessionMember& member = run_.members.at(id);
  if (member.departing) {
    return;
  }
  member.departing = true;
  member.how = how;
  if (!run_.rounds.started()) {
    run_.text.keepDeparture(member.name, how);
  }
  run_.rounds.members().gone(id);
  run_.changed.add(id, member);
}

void Departures::lose(MemberId id) {
  const auto found = run_.members.find(id);
  const bool is_unknown = found != run_.members.end() && !found->second.departing &&
                          !found->second.crashing && run_.rounds.started() && !run_.rounds.ended();
  const bool may_be_kept = is_unknown && mayKeep(id);
  const std::string killed =
      run_.text.quoted(id) + " ended" + run_.text.at() +
      " without a word, as a process that somebody kills when the wall clock says so";
  die(id, "its connection was lost");
  if (may_be_kept) {
    run_.interruption.keep({Interruption::Label::Kind::kInput, id, killed});
  } else if (is_unknown) {
    run_.labels.addNotRepeatable(killed);
  }
}

void Departures::die(MemberId id, const std::string& how) {
  const auto found = run_.members.find(id);
  if (found == run_.members.end() || found->second.departing) {
    return;  // it has left: its process may end
  }
  const MemberState& state = *run_.rounds.members().find(id);
  const bool may_be_kept = mayKeep(id);
  const std::string why = run_.text.quoted(id) + " died" + run_.text.at() + ": " + how +
                          (state.owes ? " while it owed " + run_.text.owed(state) : "");
  found->second.dead = true;
  depart(id, "died");
  if (!run_.rounds.started()) {
    run_.text.keepDeparture(found->second.name, "died: " + how);
    run_.messages.say(LockstepMessage::Level::kWarn, why);
    return;
  }
  if (may_be_kept) {  // a process that does not handle the signal dies of it
    run_.interruption.keep({Interruption::Label::Kind::kDied, id, why});
  } else {
    end_.degrade(why);
  }
}

/** @return whether a label for the death of a member counts only if the run goes on without others.
 * What it owes of the last round is lost in any case. */
bool Departures::mayKeep(MemberId id) const {
  return run_.interruption.isActive() &&
         !(run_.rounds.isFinishing() && run_.rounds.members().find(id)->owes);
}

bool Departures::holdTime() {
  if (!run_.interruption.isActive()) {
    return false;
  }
  const bool anybody_stays =
      std::any_of(run_.members.begin(), run_.members.end(), [this](const auto& entry) {
        return !entry.second.departing && !run_.interruption.concerns(entry.first);
      });
  if (!anybody_stays) {
    endTogether();
    return false;
  }
  if (run_.wall < run_.interruption.due()) {
    return true;
  }
  goOnWithoutSome();
  return false;
}

/**
 * @brief All participants end. Nothing that they did in the unfinished round counts, whichever was
 * first.
 */
void Departures::endTogether() {
  for (auto& [id, member] : run_.members) {
    if (!member.departing) {
      run_.connections.close(member.connection, "all participants were told to end");
      depart(id, "was told to end");
    }
    member.turn = PendingTurn();
    member.played.stop();
    member.walked.clear();
  }
  if (!run_.interruption.rested()) {
    end_.cut();
  }
  run_.interruption.finish();
  are_together_ = true;
}

void Departures::goOnWithoutSome() {
  using Kind = Interruption::Label::Kind;
  for (const Interruption::Label& label : run_.interruption.finish()) {
    if (label.kind == Kind::kDied) {
      end_.degrade(label.text);
    } else if (label.kind == Kind::kInput || goesOnWithout(label.member)) {
      run_.labels.addNotRepeatable(label.text);
    }
  }
}

/**
 * @return whether other participants still have something to do, so that it matters when @p id
 * leaves.
 */
bool Departures::goesOnWithout(MemberId id) const {
  if (run_.carriage.held.hasForOthers(id)) {
    return true;
  }
  return std::any_of(
      run_.rounds.members().all().begin(), run_.rounds.members().all().end(),
      [id](const auto& entry) {
        return entry.first != id && entry.second.present &&
               (entry.second.owes || entry.second.next != kNever || !entry.second.arrivals.empty());
      });
}

void Departures::apply(MemberId id) {
  SessionMember& member = run_.members.at(id);
  if (!member.dead) {
    run_.messages.say(
        LockstepMessage::Level::kInfo,
        run_.text.quoted(id) + " " + member.how + (run_.rounds.started() ? run_.text.at() : ""));
  }
  if (run_.rounds.started() && !run_.rounds.ended() && !are_together_ &&
      list_.size() < kMostDepartures) {
    list_.push_back({member.name, run_.rounds.now(), member.dead});
  }
  end_.noteDeparture(member, run_.text.quoted(id) + " " + member.how);
  run_.router.remove(id, member.actions);
  run_.rounds.remove(id);
  run_.looked_at.erase(member.name);
  run_.members.erase(id);
  gone_.push_back(id);
}

void Departures::sayGone() {
  for (const MemberId id : gone_) {
    const std::string news = wire::encode(wire::MasterFrame(wire::Gone{id}));
    for (const auto& [other, member] : run_.members) {
      run_.connections.send(member.connection, news);
    }
  }
  gone_.clear();
}

}  // namespace move_base_abstract
