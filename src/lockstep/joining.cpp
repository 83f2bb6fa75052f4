// How participants join: which nodes may take part, with which number, and how the others learn of
// them.

#include "joining.h"

#include <algorithm>

#include "clock/number_text.h"
#include "clock/shown_text.h"
#include "welcome.h"

namespace move_base_abstract {
namespace {

constexpr std::uint64_t kRefusalsTold = 10;  // one by one; then each one that doubles the number

/** @return whether both are the same. The comparison takes the same time wherever they differ. */
bool isSameSecret(std::string_view one, std::string_view other) {
  unsigned difference = one.size() == other.size() ? 0U : 1U;
  for (std::size_t k = 0; k < one.size() && !other.empty(); ++k) {
    difference |= static_cast<unsigned char>(one[k]) ^
                  static_cast<unsigned>(static_cast<unsigned char>(other[k % other.size()]));
  }
  return difference == 0;
}

}  // namespace

Joining::Joining(LockstepRun& run, Departures& departures)
    : run_(run),
      departures_(departures),
      last_id_(static_cast<MemberId>(run.settings.participants.size())) {}

void Joining::check(const wire::Hello& hello) const {
  if (hello.protocol != wire::kProtocol) {
    throw wire::MalformedFrame("protocol must be " + std::to_string(wire::kProtocol) + ", got " +
                               std::to_string(hello.protocol) + " from " + quote(hello.name) +
                               ": build both from the same version");
  }
  if (hello.name.empty()) {
    throw wire::MalformedFrame("HELLO must have a name, got an empty one");
  }
  if (hello.name.size() > kLongestName || hasControlCharacters(hello.name)) {
    throw wire::MalformedFrame("HELLO must have a name of at most " + std::to_string(kLongestName) +
                               " bytes without control characters, got '" +
                               shown(hello.name, kLongestName) + "'");
  }
  if (!run_.settings.secret.empty() && !isSameSecret(hello.secret, run_.settings.secret)) {
    throw wire::MalformedFrame(
        "HELLO must have the secret of the run, got " +
        std::string(hello.secret.empty() ? "none" : "another") + " from " + quote(hello.name) +
        ": set lockstep_secret_file, or lockstep_secret, for all (parameters of "
        "/time_master)");
  }
}

void Joining::greet(ConnectionId id, const wire::Hello& hello) {
  check(hello);
  replaceOlder(hello.name);
  const MemberId own = freshId(hello.name);
  run_.connections.greeted(id, own);
  SessionMember& member = run_.members[own];
  member.connection = id;
  member.name = hello.name;
  member.node_uri = hello.node_uri;
  run_.rounds.add(own, member.name, rankOf(hello), run_.wall);
  run_.router.add(own, member.name);
  if (run_.radio != nullptr) {
    run_.radio->join(own, member.name);
  }
  label(hello.name, hello.rank_declared);
  introduce(own, encodeWelcome(own, hello, run_.settings));
  run_.messages.say(
      LockstepMessage::Level::kInfo,
      quote(hello.name) + " takes part" + (run_.rounds.started() ? run_.text.at() : ""));
}

/** @brief Tell the newcomer of all others, and the others of it. */
void Joining::introduce(MemberId id, const std::string& welcome) {
  const SessionMember& newcomer = run_.members.at(id);
  run_.connections.send(newcomer.connection, welcome);
  const std::string news =
      wire::encode(wire::MasterFrame(wire::Member{id, newcomer.name, newcomer.node_uri}));
  for (const auto& [other, member] : run_.members) {
    if (other != id) {
      run_.connections.send(member.connection, news);
      run_.connections.send(
          newcomer.connection,
          wire::encode(wire::MasterFrame(wire::Member{other, member.name, member.node_uri})));
    }
  }
}

void Joining::replaceOlder(std::string_view name) {
  for (auto& [id, member] : run_.members) {
    if (member.name == name && !member.departing) {
      run_.connections.close(member.connection, "replaced: another " + quote(name) + " has joined");
      departures_.depart(id, "was replaced by another of its name");
      run_.labels.addNotRepeatable(quote(name) + " was replaced by another of its name" +
                                   run_.text.at());
    }
  }
}

/**
 * @return a number for a new member. A named participant gets its own number the first time, so
 * that its number is the same in every run.
 */
MemberId Joining::freshId(std::string_view name) {
  const auto& named = run_.settings.participants;
  const auto found = std::find(named.begin(), named.end(), name);
  if (found != named.end()) {
    const auto id = static_cast<MemberId>(found - named.begin() + 1);
    if (used_ids_.insert(id).second) {
      return id;
    }
  }
  return ++last_id_;
}

void Joining::label(std::string_view name, bool rank_declared) {
  const auto& named = run_.settings.participants;
  if (run_.rounds.started()) {
    run_.labels.addNotRepeatable(quote(name) + " joined" + run_.text.at() + ", after the start");
  } else if (!named.empty() && std::find(named.begin(), named.end(), name) == named.end()) {
    run_.labels.addNotRepeatable(quote(name) + " takes part but is not named in 'participants'");
  }
  if (isAnonymous(name) && !rank_declared) {
    run_.labels.addNotRepeatable(
        quote(name) +
        " has a name of this run only, and no declared rank: its place among equal events differs "
        "from run to run; give it ~lockstep_rank or a name");
  }
}

void Joining::refuse(ConnectionId id, const std::string& reason) {
  run_.connections.close(id, reason);
  ++refused_;
  const bool doubled = (refused_ & (refused_ - 1)) == 0;
  if (refused_ <= kRefusalsTold || doubled) {
    const std::string count =
        refused_ <= kRefusalsTold ? "" : " (" + std::to_string(refused_) + " so far)";
    run_.messages.say(LockstepMessage::Level::kWarn,
                      "a connection was refused" + count + ": " + reason);
  }
}

void Joining::dropSilentStrangers() {
  while (const ConnectionId id = run_.connections.silentStranger(run_.wall)) {
    refuse(id, "it has said no HELLO within " + secondsText(Connections::kHelloLimit));
  }
}

}  // namespace move_base_abstract
