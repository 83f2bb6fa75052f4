// What comes in: connections, HELLO, reports, and who leaves or dies.
#include <algorithm>
#include <memory>
#include <utility>

#include "clock/number_text.h"
#include "clock/shown_text.h"
#include "foreseen.h"
#include "session.h"
#include "welcome.h"

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kHelloLimit = 10 * kNanosecondsPerSecond;  // wall
constexpr std::uint64_t kRefusalsTold = 10;  // one by one; then each that doubles their number

/** @return whether both are the same; takes the same time wherever they differ. */
bool isSameSecret(std::string_view one, std::string_view other) {
  unsigned difference = one.size() == other.size() ? 0U : 1U;
  for (std::size_t k = 0; k < one.size() && !other.empty(); ++k) {
    difference |= static_cast<unsigned char>(one[k]) ^
                  static_cast<unsigned>(static_cast<unsigned char>(other[k % other.size()]));
  }
  return difference == 0;
}

}  // namespace

// ---- connections -----------------------------------------------------------------------------

void LockstepSession::connect(ConnectionId connection, Nanoseconds wall) {
  wall_ = std::max(wall_, wall);
  connections_.add(connection, wall_ + kHelloLimit);
  if (rounds_.ended()) {
    connections_.close(connection, reason_);
  }
}

void LockstepSession::received(ConnectionId id, std::string_view bytes, Nanoseconds wall) {
  wall_ = std::max(wall_, wall);
  Connection* const connection = connections_.open(id);
  if (connection == nullptr) {
    return;
  }
  poll_due_ = true;
  try {
    connection->buffer.append(bytes);
    while (const auto frame = connection->buffer.next(
               connection->member == 0 ? wire::kLargestHello : wire::kLargestFrame)) {
      take(id, *connection, *frame);
      if (connection->close) {
        return;
      }
    }
  } catch (const wire::MalformedFrame& error) {
    drop(id, *connection, error.what());
  }
}

void LockstepSession::take(ConnectionId id, const Connection& connection, std::string_view frame) {
  const bool greeted = connection.member != 0;
  const auto member = members_.find(connection.member);
  if (greeted && (member == members_.end() || member->second.departing)) {
    return;  // it has left; what it still says does not count
  }
  // A report is decoded where it stays, since what it contains points into its bytes.
  if (greeted && wire::isReport(frame)) {
    return takeReport(connection.member, frame);
  }
  const wire::ParticipantFrame decoded = wire::decodeFromParticipant(frame);
  if (const auto* greeting = std::get_if<wire::Hello>(&decoded); greeting && !greeted) {
    hello(id, *greeting);
  } else if (std::holds_alternative<wire::Knock>(decoded) && greeted) {
    takeKnock(connection.member);
  } else if (const auto* leave = std::get_if<wire::Leave>(&decoded); leave && greeted) {
    takeLeave(connection.member, *leave);
  } else if (const auto* stopping = std::get_if<wire::Stopping>(&decoded); stopping && greeted) {
    takeStopping(connection.member, *stopping);
  } else if (const auto* busy = std::get_if<wire::Busy>(&decoded); busy && greeted) {
    takeBusy(connection.member, *busy);
  } else {
    throw wire::MalformedFrame(greeted ? "HELLO must come once, got another"
                                       : "the first frame must be HELLO, got another type");
  }
}

void LockstepSession::disconnected(ConnectionId id, Nanoseconds wall) {
  wall_ = std::max(wall_, wall);
  if (!connections_.contains(id)) {
    return;
  }
  poll_due_ = true;
  interruption_.lost(id, wall_);
  if (const MemberId member = connections_.remove(id); member != 0) {
    die(member, "its connection was lost");
  }
}

/** @brief What came over the connection cannot be trusted any more. */
void LockstepSession::drop(ConnectionId id, const Connection& connection,
                           const std::string& reason) {
  if (connection.member == 0) {
    refuseConnection(id, reason);
    return;
  }
  connections_.close(id, reason);
  die(connection.member, "it was dropped: " + reason);
}

/** @brief A stranger is sent away. Thousands of them do not fill the log. */
void LockstepSession::refuseConnection(ConnectionId id, const std::string& reason) {
  connections_.close(id, reason);
  ++refused_;
  const bool doubled = (refused_ & (refused_ - 1)) == 0;
  if (refused_ <= kRefusalsTold || doubled) {
    const std::string count =
        refused_ <= kRefusalsTold ? "" : " (" + std::to_string(refused_) + " so far)";
    messages_.say(Level::kWarn, "a connection was refused" + count + ": " + reason);
  }
}

void LockstepSession::dropSilentStrangers() {
  while (const ConnectionId id = connections_.silentStranger(wall_)) {
    refuseConnection(id, "it has said no HELLO within " + secondsText(kHelloLimit));
  }
}

// ---- joining ---------------------------------------------------------------------------------

/** @throws wire::MalformedFrame unless it may take part. */
void LockstepSession::checkHello(const wire::Hello& hello) const {
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
  if (!settings_.secret.empty() && !isSameSecret(hello.secret, settings_.secret)) {
    throw wire::MalformedFrame(
        "HELLO must have the secret of the run, got " +
        std::string(hello.secret.empty() ? "none" : "another") + " from " + quote(hello.name) +
        ": set lockstep_secret_file, or lockstep_secret, for all (parameters of "
        "/time_master)");
  }
}

void LockstepSession::hello(ConnectionId id, const wire::Hello& hello) {
  checkHello(hello);
  replaceOlder(hello.name);
  const MemberId own = freshId(hello.name);
  connections_.greeted(id, own);
  Member& member = members_[own];
  member.connection = id;
  member.name = hello.name;
  member.node_uri = hello.node_uri;
  rounds_.add(own, member.name, rankOf(hello), wall_);
  router_.add(own, member.name);
  labelJoin(hello.name, hello.rank_declared);
  introduce(own, encodeWelcome(own, hello, settings_));
  messages_.say(Level::kInfo,
                quote(hello.name) + " takes part" + (rounds_.started() ? text_.at() : ""));
}

/** @brief The newcomer hears of all others, and they of it. */
void LockstepSession::introduce(MemberId id, const std::string& welcome) {
  const Member& newcomer = members_.at(id);
  connections_.send(newcomer.connection, welcome);
  const std::string news =
      wire::encode(wire::MasterFrame(wire::Member{id, newcomer.name, newcomer.node_uri}));
  for (const auto& [other, member] : members_) {
    if (other != id) {
      connections_.send(member.connection, news);
      connections_.send(
          newcomer.connection,
          wire::encode(wire::MasterFrame(wire::Member{other, member.name, member.node_uri})));
    }
  }
}

void LockstepSession::replaceOlder(std::string_view name) {
  for (auto& [id, member] : members_) {
    if (member.name == name && !member.departing) {
      connections_.close(member.connection, "replaced: another " + quote(name) + " has joined");
      depart(id, "was replaced by another of its name");
      labels_.addNotRepeatable(quote(name) + " was replaced by another of its name" + text_.at());
    }
  }
}

/** @return a named participant's own number the first time, so that numbers are those of any run.
 */
MemberId LockstepSession::freshId(std::string_view name) {
  const auto& named = settings_.participants;
  const auto found = std::find(named.begin(), named.end(), name);
  if (found != named.end()) {
    const auto id = static_cast<MemberId>(found - named.begin() + 1);
    if (used_ids_.insert(id).second) {
      return id;
    }
  }
  return ++last_id_;
}

void LockstepSession::labelJoin(std::string_view name, bool rank_declared) {
  const auto& named = settings_.participants;
  if (rounds_.started()) {
    labels_.addNotRepeatable(quote(name) + " joined" + text_.at() + ", after the start");
  } else if (!named.empty() && std::find(named.begin(), named.end(), name) == named.end()) {
    labels_.addNotRepeatable(quote(name) + " takes part but is not named in 'participants'");
  }
  if (isAnonymous(name) && !rank_declared) {
    labels_.addNotRepeatable(
        quote(name) +
        " has a name of this run only, and no declared rank: its place among equal events differs "
        "from run to run; give it ~lockstep_rank or a name");
  }
}

// ---- what participants say -------------------------------------------------------------------

void LockstepSession::takeReport(MemberId id, std::string_view frame) {
  Member& member = members_.at(id);
  const auto bytes = std::make_shared<const std::string>(frame);
  auto report = std::get<wire::Report>(wire::decodeFromParticipant(*bytes));
  const LockstepRounds::MemberState& state = *rounds_.find(id);
  if (!state.owes || state.round != report.round) {
    throw wire::MalformedFrame("REPORT must be of the round that was granted, " +
                               (state.owes ? std::to_string(state.round) : "none") + ", got " +
                               std::to_string(report.round));
  }
  const bool is_last = report.leaving;
  if (rounds_.hasWindows()) {
    takeTurns(id, std::move(report), bytes);
  } else {
    Foreseen foreseen = takeForeseen(report, bytes, rounds_.now());
    rounds_.report(id, is_last ? kNever : report.next_ns, is_last ? 0 : report.open, wall_,
                   std::move(foreseen.instants));
    member.foreseen = std::move(foreseen.turns);
    member.turn = {bytes, std::move(report.items)};
  }
  listChanged(id);
  if (is_last) {
    if (interruption_.concerns(id)) {
      keepLeft(id);
    }
    depart(id, "left");
  }
}

void LockstepSession::takeKnock(MemberId id) {
  Member& member = members_.at(id);
  rounds_.knock(id);
  if (rounds_.started() && !member.input_told) {
    member.input_told = true;
    const std::string why = quote(member.name) + " had input from outside" + text_.at();
    if (interruption_.isActive()) {
      interruption_.knocked(id);
      interruption_.keep({Interruption::Label::Kind::kInput, id, why});  // none enters as yet
    } else {
      labels_.addNotRepeatable(why);
    }
  }
}

void LockstepSession::depart(MemberId id, const std::string& how) {
  Member& member = members_.at(id);
  if (member.departing) {
    return;
  }
  member.departing = true;
  member.how = how;
  if (!rounds_.started()) {
    text_.keepDeparture(member.name, how);
  }
  rounds_.gone(id);
  listChanged(id);
}

void LockstepSession::die(MemberId id, const std::string& how) {
  const auto found = members_.find(id);
  if (found == members_.end() || found->second.departing) {
    return;  // it has left, and so may go
  }
  const LockstepRounds::MemberState& state = *rounds_.find(id);
  const std::string why = text_.quoted(id) + " died" + text_.at() + ": " + how +
                          (state.owes ? " while it owed " + text_.owed(state) : "");
  found->second.dead = true;
  depart(id, "died");
  if (!rounds_.started()) {
    text_.keepDeparture(found->second.name, "died: " + how);
    messages_.say(Level::kWarn, why);
    return;
  }
  if (interruption_.isActive()) {  // who knows no such signal dies of it
    interruption_.keep({Interruption::Label::Kind::kDied, id, why});
  } else {
    degrade(why);
  }
}

void LockstepSession::listChanged(MemberId id) {
  Member& member = members_.at(id);
  if (!member.listed) {
    member.listed = true;
    changed_.push_back(id);
  }
}

}  // namespace move_base_abstract
