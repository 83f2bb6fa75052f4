#include "session.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "clock/number_text.h"
#include "clock/shown_text.h"

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kMissingGap = 5 * kNanosecondsPerSecond;   // wall
constexpr Nanoseconds kHelloLimit = 10 * kNanosecondsPerSecond;  // wall
constexpr std::uint64_t kRefusalsTold = 10;  // one by one; then each that doubles their number
constexpr std::size_t kMostLabels = 100;     // of a kind

std::string quote(std::string_view name) { return "'" + std::string(name) + "'"; }

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) {
    text += (text.empty() ? "" : ", ") + part;
  }
  return text;
}

/** @brief Whether ROS made the name unique with a process number and the wall time. */
bool isAnonymous(std::string_view name) {
  const std::size_t digits = name.find_last_not_of("0123456789");
  return digits != std::string_view::npos && name[digits] == '_' && name.size() - digits - 1 >= 13;
}

/** @return whether both are the same; takes the same time wherever they differ. */
bool isSameSecret(std::string_view one, std::string_view other) {
  unsigned difference = one.size() == other.size() ? 0U : 1U;
  for (std::size_t k = 0; k < one.size() && !other.empty(); ++k) {
    difference |= static_cast<unsigned char>(one[k]) ^
                  static_cast<unsigned>(static_cast<unsigned char>(other[k % other.size()]));
  }
  return difference == 0;
}

/** @brief Add a label that is not there yet. @return what is to be said of it; '' if nothing. */
std::string addLabel(std::vector<std::string>& labels, const std::string& text) {
  const std::string label =
      labels.size() < kMostLabels ? shown(text) : "and more; only the first are listed";
  if (std::find(labels.begin(), labels.end(), label) != labels.end()) {
    return "";
  }
  labels.push_back(label);
  return label;
}

std::string jsonText(std::string_view text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      json += '\\';
      json += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char escape[8];
      std::snprintf(escape, sizeof(escape), "\\u%04x", static_cast<unsigned>(c));
      json += escape;
    } else {
      json += c;
    }
  }
  return json + '"';
}

/** @return FNV-1a, 64 bits, in hex. */
std::string hashText(std::string_view bytes) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  for (const char byte : bytes) {
    hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001B3U;
  }
  char text[20];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace

LockstepSession::LockstepSession(const LockstepSettings& settings, Nanoseconds wall,
                                 const LockstepRules& rules)
    : settings_(settings),
      rules_(rules),
      rounds_(settings, rules),
      router_([this](MemberId id, Mail mail) { rounds_.post(id, mail); },
              [this](MemberId id, std::uint32_t sub, std::uint64_t number) {
                return rounds_.order(id, sub, number);
              },
              settings.log_messages
                  ? MessageRouter::Trace([this](const auto& delivery) { trace(delivery); })
                  : MessageRouter::Trace(),
              rules),
      wall_(wall),
      began_(wall),
      missing_due_(settings.participants.empty() ? kNever : wall + kMissingGap),
      last_id_(static_cast<MemberId>(settings.participants.size())) {}

// ---- connections -----------------------------------------------------------------------------

void LockstepSession::connect(ConnectionId connection, Nanoseconds wall) {
  wall_ = std::max(wall_, wall);
  connections_[connection];
  if (rounds_.ended()) {
    close(connection, reason_);
  } else {
    hello_due_[connection] = wall_ + kHelloLimit;
  }
}

void LockstepSession::received(ConnectionId id, std::string_view bytes, Nanoseconds wall) {
  wall_ = std::max(wall_, wall);
  const auto found = connections_.find(id);
  if (found == connections_.end() || found->second.close) {
    return;
  }
  Connection& connection = found->second;
  poll_due_ = true;
  try {
    connection.buffer.append(bytes);
    while (const auto frame = connection.buffer.next(
               connection.member == 0 ? wire::kLargestHello : wire::kLargestFrame)) {
      take(id, connection, *frame);
      if (connection.close) {
        return;
      }
    }
  } catch (const wire::MalformedFrame& error) {
    drop(id, error.what());
  }
}

void LockstepSession::take(ConnectionId id, Connection& connection, std::string_view frame) {
  const bool greeted = connection.member != 0;
  const auto member = members_.find(connection.member);
  if (greeted && (member == members_.end() || member->second.departing)) {
    return;  // it has left; what it still says does not count
  }
  // A report is decoded where it stays, since what it contains points into its bytes.
  constexpr char kReportType = 2;
  if (greeted && !frame.empty() && frame[0] == kReportType) {
    return takeReport(connection.member, frame);
  }
  const wire::ParticipantFrame decoded = wire::decodeFromParticipant(frame);
  if (const auto* greeting = std::get_if<wire::Hello>(&decoded); greeting && !greeted) {
    hello(id, connection, *greeting);
  } else if (std::holds_alternative<wire::Knock>(decoded) && greeted) {
    takeKnock(connection.member);
  } else if (const auto* leave = std::get_if<wire::Leave>(&decoded); leave && greeted) {
    takeLeave(connection.member, *leave);
  } else {
    throw wire::MalformedFrame(greeted ? "HELLO must come once, got another"
                                       : "the first frame must be HELLO, got another type");
  }
}

void LockstepSession::disconnected(ConnectionId id, Nanoseconds wall) {
  wall_ = std::max(wall_, wall);
  const auto found = connections_.find(id);
  if (found == connections_.end()) {
    return;
  }
  const MemberId member = found->second.member;
  connections_.erase(found);
  hello_due_.erase(id);
  poll_due_ = true;
  if (member != 0) {
    die(member, "its connection was lost");
  }
}

/** @brief What came over the connection cannot be trusted any more. */
void LockstepSession::drop(ConnectionId id, const std::string& reason) {
  const MemberId member = connections_.at(id).member;
  if (member == 0) {
    refuseConnection(id, reason);
    return;
  }
  close(id, reason);
  die(member, "it was dropped: " + reason);
}

/** @brief A stranger is sent away. Thousands of them do not fill the log. */
void LockstepSession::refuseConnection(ConnectionId id, const std::string& reason) {
  close(id, reason);
  ++refused_;
  const bool doubled = (refused_ & (refused_ - 1)) == 0;
  if (refused_ <= kRefusalsTold || doubled) {
    const std::string count =
        refused_ <= kRefusalsTold ? "" : " (" + std::to_string(refused_) + " so far)";
    say(Level::kWarn, "a connection was refused" + count + ": " + reason);
  }
}

void LockstepSession::dropSilentStrangers() {
  while (!hello_due_.empty() && hello_due_.begin()->second <= wall_) {
    const ConnectionId id = hello_due_.begin()->first;
    refuseConnection(id, "it has said no HELLO within " + secondsText(kHelloLimit));
    hello_due_.erase(id);
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

void LockstepSession::hello(ConnectionId id, Connection& connection, const wire::Hello& hello) {
  checkHello(hello);
  hello_due_.erase(id);
  if (rules_.replace) {
    replaceOlder(hello.name);
  }
  const MemberId own = freshId(hello.name);
  connection.member = own;
  Member& member = members_[own];
  member.connection = id;
  member.name = hello.name;
  member.node_uri = hello.node_uri;
  rounds_.add(own, member.name, hello.rank, wall_);
  router_.add(own, member.name);
  labelJoin(hello.name, hello.rank_declared);
  introduce(own);
  say(Level::kInfo, quote(hello.name) + " takes part" + (rounds_.started() ? at() : ""));
}

/** @brief The newcomer hears of all others, and they of it. */
void LockstepSession::introduce(MemberId id) {
  const Member& newcomer = members_.at(id);
  send(newcomer.connection, wire::encode(wire::MasterFrame(wire::Welcome{id})));
  const std::string news =
      wire::encode(wire::MasterFrame(wire::Member{id, newcomer.name, newcomer.node_uri}));
  for (const auto& [other, member] : members_) {
    if (other != id) {
      send(member.connection, news);
      send(newcomer.connection,
           wire::encode(wire::MasterFrame(wire::Member{other, member.name, member.node_uri})));
    }
  }
}

void LockstepSession::replaceOlder(std::string_view name) {
  for (auto& [id, member] : members_) {
    if (member.name == name && !member.departing) {
      close(member.connection, "replaced: another " + quote(name) + " has joined");
      depart(id, "was replaced by another of its name");
      labelNotRepeatable(quote(name) + " was replaced by another of its name" + at());
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
    labelNotRepeatable(quote(name) + " joined" + at() + ", after the start");
  } else if (!named.empty() && std::find(named.begin(), named.end(), name) == named.end()) {
    labelNotRepeatable(quote(name) + " takes part but is not named in 'participants'");
  }
  if (isAnonymous(name) && !rank_declared) {
    labelNotRepeatable(quote(name) + " has a name of this run only, and no declared rank");
  }
}

// ---- what participants say -------------------------------------------------------------------

void LockstepSession::takeReport(MemberId id, std::string_view frame) {
  Member& member = members_.at(id);
  PendingReport pending;
  pending.frame = std::make_unique<const std::string>(frame);
  pending.report = std::get<wire::Report>(wire::decodeFromParticipant(*pending.frame));
  const LockstepRounds::MemberState& state = *rounds_.find(id);
  const wire::Report& report = pending.report;
  if (!state.owes || state.round != report.round) {
    throw wire::MalformedFrame("REPORT must be of the round that was granted, " +
                               (state.owes ? std::to_string(state.round) : "none") + ", got " +
                               std::to_string(report.round));
  }
  rounds_.report(id, report.leaving ? kNever : report.next_ns, report.leaving ? 0 : report.open,
                 wall_);
  const bool leaving = report.leaving;
  member.report = std::move(pending);
  listChanged(id);
  if (leaving) {
    depart(id, "left");
  }
}

void LockstepSession::takeKnock(MemberId id) {
  Member& member = members_.at(id);
  rounds_.knock(id);
  if (rounds_.started() && !member.input_told) {
    member.input_told = true;
    labelNotRepeatable(quote(member.name) + " had input from outside" + at());
  }
}

void LockstepSession::takeLeave(MemberId id, const wire::Leave& leave) {
  if (rounds_.started() && goesOnWithout(id)) {
    labelNotRepeatable(quoted(id) + " left" + at() + ", when the wall clock said so");
  }
  depart(id, "left" + (leave.reason.empty() ? "" : " (" + std::string(leave.reason) + ")"));
}

/** @return whether others have something to do yet, so that it matters when this one leaves. */
bool LockstepSession::goesOnWithout(MemberId id) const {
  return std::any_of(rounds_.members().begin(), rounds_.members().end(), [id](const auto& entry) {
    return entry.first != id && entry.second.present &&
           (entry.second.owes || entry.second.next != kNever);
  });
}

void LockstepSession::depart(MemberId id, const std::string& how) {
  Member& member = members_.at(id);
  if (member.departing) {
    return;
  }
  member.departing = true;
  member.how = how;
  rounds_.gone(id);
  listChanged(id);
}

void LockstepSession::die(MemberId id, const std::string& how) {
  const auto found = members_.find(id);
  if (found == members_.end() || found->second.departing) {
    return;  // it has left, and so may go
  }
  const LockstepRounds::MemberState& state = *rounds_.find(id);
  const std::string why = quoted(id) + " died" + at() + ": " + how +
                          (state.owes ? " while it owed " + owed(state) : "");
  found->second.dead = true;
  depart(id, "died");
  if (!rounds_.started()) {
    say(Level::kWarn, why);
    return;
  }
  labelDegraded(why);
  if (settings_.on_death == OnDeath::kEnd && death_.empty()) {
    death_ = why;
  }
}

void LockstepSession::listChanged(MemberId id) {
  Member& member = members_.at(id);
  if (!member.listed) {
    member.listed = true;
    changed_.push_back(id);
  }
}

void LockstepSession::labelNotRepeatable(const std::string& why) {
  const std::string added = addLabel(not_repeatable_, why);
  if (!added.empty()) {
    say(Level::kInfo, "the run is not repeatable: " + added);
  }
}

void LockstepSession::labelDegraded(const std::string& why) {
  const std::string added = addLabel(degraded_, why);
  if (!added.empty()) {
    say(Level::kWarn, "the run is degraded: " + added);
  }
}

// ---- the end of a round ----------------------------------------------------------------------

std::vector<LockstepSession::Output> LockstepSession::poll(Nanoseconds wall) {
  wall_ = std::max(wall_, wall);
  poll_due_ = false;
  if (!rounds_.ended()) {
    rounds_.watch(wall_);
    handleEvents();
    if (rounds_.settled()) {
      applyRound();
      if (!death_.empty()) {
        end(death_);
      }
      sendGrants(rounds_.decide(wall_));
      sayGone();
      handleEvents();
    }
    nameMissing();
    dropSilentStrangers();
  }
  return flush();
}

void LockstepSession::applyRound() {
  if (changed_.empty()) {
    return;
  }
  std::vector<MemberId> ids;
  ids.swap(changed_);
  if (rules_.apply_in_order) {
    std::sort(ids.begin(), ids.end(), [this](auto a, auto b) { return rounds_.before(a, b); });
  }
  for (const MemberId id : ids) {
    Member& member = members_.at(id);
    member.listed = false;
    const bool cancelled = member.dead && !rules_.dead_delivers;
    if (member.report.frame && !cancelled) {
      applyReport(id, member);
    }
    if (member.departing) {
      applyDeparture(id);
    }
  }
  router_.finishRound();
  changed_.clear();  // who is dropped for its report has departed in its turn
  closeRoundLog();
  for (const std::string& warning : router_.takeWarnings()) {
    say(Level::kWarn, warning);
  }
}

void LockstepSession::applyReport(MemberId id, Member& member) {
  PendingReport pending = std::move(member.report);
  member.report = PendingReport();
  try {
    for (const wire::ReportItem& item : pending.report.items) {
      applyItem(id, member, item);
    }
  } catch (const MessageRouter::BadAction& error) {
    close(member.connection, error.what());
    die(id, std::string("it was dropped: ") + error.what());
  }
  applied_.push_back(std::move(pending));
}

void LockstepSession::applyItem(MemberId id, Member& member, const wire::ReportItem& item) {
  const std::uint64_t number = member.actions++;
  if (const auto* log = std::get_if<wire::Log>(&item)) {
    applyLog(id, number, *log);
  } else if (const auto* note = std::get_if<wire::Note>(&item)) {
    applyNote(member, *note);
  } else {
    router_.apply(id, number, item);
  }
}

void LockstepSession::applyNote(Member& member, const wire::Note& note) {
  switch (note.what) {
    case wire::NoteKind::kWaitsFor:
      member.waits_for = shown(note.text);
      break;
    case wire::NoteKind::kNotRepeatable:
      labelNotRepeatable(quote(member.name) + ": " + std::string(note.text));
      break;
    case wire::NoteKind::kDegraded:
      labelDegraded(quote(member.name) + ": " + std::string(note.text));
      break;
  }
}

void LockstepSession::applyLog(MemberId id, std::uint64_t number, const wire::Log& log) {
  round_log_.push_back(
      {rounds_.order(id, log.sub, number),
       {rounds_.now(), std::string(log.robot), std::string(log.kind), std::string(log.values)}});
}

void LockstepSession::applyDeparture(MemberId id) {
  Member& member = members_.at(id);
  if (!member.dead) {
    say(Level::kInfo, quoted(id) + " " + member.how + (rounds_.started() ? at() : ""));
  }
  router_.remove(id, member.actions);
  if (!member.dead || rules_.dead_not_awaited) {
    rounds_.remove(id);
  }
  members_.erase(id);
  gone_.push_back(id);
}

void LockstepSession::trace(const MessageRouter::Delivery& delivery) {
  using Kind = MessageRouter::Delivery::Kind;
  std::vector<std::string> receivers;
  for (const MemberId id : delivery.receivers) {
    receivers.push_back(nameOf(id));
  }
  std::sort(receivers.begin(), receivers.end(), naturalLess);
  std::string values = "[" + jsonText(delivery.sender == 0 ? "" : nameOf(delivery.sender));
  for (const std::string& receiver : receivers) {
    values += "," + jsonText(receiver);
  }
  if (delivery.kind == Kind::kResponse) {
    values += "," + std::to_string(static_cast<int>(delivery.status));
  }
  values += "," + std::to_string(delivery.bytes.size()) + ",\"" + hashText(delivery.bytes) + "\"]";
  const char* kind = delivery.kind == Kind::kMessage ? "message"
                     : delivery.kind == Kind::kCall  ? "call"
                                                     : "response";
  round_log_.push_back(
      {delivery.order, {rounds_.now(), std::string(delivery.name), kind, std::move(values)}});
}

void LockstepSession::closeRoundLog() {
  std::stable_sort(round_log_.begin(), round_log_.end(),
                   [this](const OrderedLog& a, const OrderedLog& b) {
                     if (rounds_.before(a.order, b.order)) {
                       return true;
                     }
                     // Of one action (who dies cancels several calls) by what they say.
                     return !rounds_.before(b.order, a.order) && a.entry.values < b.entry.values;
                   });
  for (OrderedLog& line : round_log_) {
    log_.push_back(std::move(line.entry));
  }
  round_log_.clear();
}

void LockstepSession::sendGrants(const std::vector<LockstepRounds::Grant>& grants) {
  std::string items;
  if (!grants.empty()) {
    granted_.clear();
  }
  for (const LockstepRounds::Grant& grant : grants) {
    items.clear();
    granted_.push_back(grant.member);
    for (const Mail& mail : grant.mail) {
      wire::append(items, mail.item);
    }
    const auto member = members_.find(grant.member);
    if (member != members_.end()) {
      send(member->second.connection,
           wire::encodeGrant({grant.round, grant.time, grant.microstep, {}}, items));
    }
  }
  if (!rounds_.mailWaiting()) {
    applied_.clear();
  }
}

ConnectionId LockstepSession::lastAwaited() {
  while (!granted_.empty()) {
    const auto member = members_.find(granted_.back());
    const LockstepRounds::MemberState* const state = rounds_.find(granted_.back());
    if (member != members_.end() && state != nullptr && state->owes) {
      return member->second.connection;
    }
    granted_.pop_back();
  }
  return 0;
}

/** @brief Only now, since the grants before it may still contain the last words of those. */
void LockstepSession::sayGone() {
  for (const MemberId id : gone_) {
    const std::string news = wire::encode(wire::MasterFrame(wire::Gone{id}));
    for (const auto& [other, member] : members_) {
      send(member.connection, news);
    }
  }
  gone_.clear();
}

// ---- events ----------------------------------------------------------------------------------

void LockstepSession::handleEvents() {
  for (const LockstepRounds::Event& event : rounds_.takeEvents()) {
    handle(event);
  }
}

void LockstepSession::handle(const LockstepRounds::Event& event) {
  using Kind = LockstepRounds::Event::Kind;
  switch (event.kind) {
    case Kind::kStarted:
      missing_due_ = kNever;
      if (settings_.participants.empty()) {
        labelNotRepeatable(
            "no participants are named: who takes part from the start on depends on the wall "
            "clock");
      }
      say(Level::kInfo,
          "the clock starts" + at() + " with " + countText(members_.size(), "participant"));
      break;
    case Kind::kSilent:
    case Kind::kAnswered:
      handleSilence(event);
      break;
    case Kind::kTargetReached:
      say(Level::kDebug, "reached " + secondsText(rounds_.now()) + ", paused");
      break;
    case Kind::kIdle:
    case Kind::kDeadlock:
    case Kind::kZeroDelayLoop:
      handleStandstill(event);
      break;
  }
}

void LockstepSession::handleSilence(const LockstepRounds::Event& event) {
  const LockstepRounds::MemberState* member = rounds_.find(event.member);
  if (!member) {
    return;
  }
  const std::string time = secondsText(event.duration) + " of wall time";
  if (event.kind == LockstepRounds::Event::Kind::kAnswered) {
    say(Level::kInfo, quoted(event.member) + " answered after " + time);
    return;
  }
  say(Level::kWarn,
      quoted(event.member) + " has been silent for " + time + "; it owes " + owed(*member) + at());
  if (settings_.on_silence == OnSilence::kDrop) {
    const std::string reason = "it was dropped: silent for " + time;
    close(members_.at(event.member).connection, reason);
    die(event.member, reason);
  }
}

void LockstepSession::handleStandstill(const LockstepRounds::Event& event) {
  using Kind = LockstepRounds::Event::Kind;
  if (event.kind == Kind::kIdle) {
    say(Level::kDebug, "idle" + at() + ": nobody wants to wake up");
  } else {
    say(event.kind == Kind::kDeadlock ? Level::kWarn : Level::kError, standstill());
  }
  if (settings_.end_when_idle && event.kind != Kind::kZeroDelayLoop) {
    end(event.kind == Kind::kIdle ? "idle" + at() + ": nobody wants to wake up" : standstill());
  }
}

std::string LockstepSession::standstill() const {
  switch (rounds_.phase(wall_)) {
    case LockstepPhase::kDeadlock:
      return "deadlock" + at() + ": nobody wants to wake up, but " + stuck();
    case LockstepPhase::kZeroDelayLoop:
      return "zero-delay loop" + at() + ": " + std::to_string(rounds_.microstep()) +
             " microsteps at one instant, the last of them by " + latestRound();
    case LockstepPhase::kEnded:
      return reason_;
    default:
      return "";
  }
}

void LockstepSession::nameMissing() {
  if (rounds_.started() || wall_ < missing_due_) {
    return;
  }
  missing_due_ = wall_ + kMissingGap;
  std::vector<std::string> names;
  for (const std::string& name : rounds_.missing()) {
    names.push_back(quote(name));
  }
  say(Level::kInfo, "the clock does not start without " + joined(names) + " (" +
                        countText(members_.size(), "participant") + " there)");
}

Nanoseconds LockstepSession::nextWake() const {
  if (poll_due_ || !outgoing_.empty()) {
    return wall_;
  }
  const Nanoseconds hello_due = hello_due_.empty() ? kNever : hello_due_.begin()->second;
  return rounds_.ended() ? kNever : std::min({rounds_.nextWake(), missing_due_, hello_due});
}

// ---- the gate --------------------------------------------------------------------------------

void LockstepSession::pause() {
  rounds_.pause();
  poll_due_ = true;
}

void LockstepSession::resume() {
  rounds_.resume();
  poll_due_ = true;
}

Nanoseconds LockstepSession::step(Nanoseconds duration) {
  const Nanoseconds target = rounds_.step(duration);
  poll_due_ = true;
  return target;
}

void LockstepSession::runUntil(Nanoseconds target) {
  rounds_.runUntil(target);
  poll_due_ = true;
}

void LockstepSession::setLimit(double factor) {
  rounds_.setLimit(factor);
  poll_due_ = true;
}

void LockstepSession::end(const std::string& reason) {
  if (rounds_.ended()) {
    return;
  }
  rounds_.end();
  reason_ = reason;
  for (const auto& [id, connection] : connections_) {
    if (!connection.close) {
      close(id, reason);
    }
  }
  say(Level::kInfo, "the run ended" + at() + ": " + reason);
}

// ---- output ----------------------------------------------------------------------------------

void LockstepSession::send(ConnectionId id, std::string_view bytes) {
  const auto found = connections_.find(id);
  if (found != connections_.end() && !found->second.close) {
    found->second.out.append(bytes);
    list(id, found->second);
  }
}

void LockstepSession::close(ConnectionId id, const std::string& reason) {
  const auto found = connections_.find(id);
  if (found == connections_.end() || found->second.close) {
    return;
  }
  const std::string text = shown(reason);
  send(id, wire::encode(wire::MasterFrame(wire::End{text})));
  found->second.close = true;
  hello_due_.erase(id);
}

void LockstepSession::list(ConnectionId id, Connection& connection) {
  if (!connection.listed) {
    connection.listed = true;
    outgoing_.push_back(id);
  }
}

std::vector<LockstepSession::Output> LockstepSession::flush() {
  std::vector<Output> outputs;
  for (const ConnectionId id : outgoing_) {
    const auto found = connections_.find(id);
    if (found == connections_.end()) {
      continue;
    }
    Connection& connection = found->second;
    connection.listed = false;
    outputs.push_back({id, std::move(connection.out), connection.close});
    connection.out.clear();
    if (connection.close) {
      connections_.erase(found);
    }
  }
  outgoing_.clear();
  return outputs;
}

std::vector<LockstepLogEntry> LockstepSession::takeLog() {
  std::vector<LockstepLogEntry> log;
  log.swap(log_);
  return log;
}

std::vector<LockstepMessage> LockstepSession::takeMessages() {
  std::vector<LockstepMessage> messages;
  messages.swap(messages_);
  return messages;
}

// ---- what is so ------------------------------------------------------------------------------

void LockstepSession::say(Level level, const std::string& text) {
  messages_.push_back({level, shown(text)});
}

std::string LockstepSession::at() const { return " at " + secondsText(rounds_.now()); }

std::string LockstepSession::nameOf(MemberId id) const {
  const auto found = members_.find(id);
  return found == members_.end() ? "" : found->second.name;
}

std::string LockstepSession::quoted(MemberId id) const { return quote(nameOf(id)); }

std::string LockstepSession::owed(const LockstepRounds::MemberState& member) const {
  std::vector<std::string> parts;
  if (member.granted_mail > 0) {
    parts.push_back(countText(member.granted_mail, "message"));
  }
  if (member.granted_due) {
    parts.push_back("wake-up due");
  }
  return "the report of round " + std::to_string(member.round) +
         (parts.empty() ? "" : " (" + joined(parts) + ")");
}

/** @return who has threads that wait without end, and what for. */
std::string LockstepSession::stuck() const {
  std::vector<std::string> names;
  for (const LockstepStatus::Participant& member : participants()) {
    if (member.open > 0) {
      names.push_back(quote(member.name) + " has " + countText(member.open, "waiting thread") +
                      (member.waits_for.empty() ? "" : " (" + member.waits_for + ")"));
    }
  }
  return joined(names);
}

std::string LockstepSession::latestRound() const {
  std::vector<std::string> names;
  for (const MemberId id : rounds_.latestRound()) {
    if (members_.count(id) != 0) {
      names.push_back(quoted(id));
    }
  }
  return joined(names);
}

std::vector<LockstepStatus::Waiting> LockstepSession::waitingFor() const {
  std::vector<LockstepStatus::Waiting> waiting;
  if (!rounds_.started()) {
    for (const std::string& name : rounds_.missing()) {
      waiting.push_back({name, began_, "its HELLO"});
    }
    return waiting;
  }
  for (const MemberId id : rounds_.latestRound()) {
    const LockstepRounds::MemberState* member = rounds_.find(id);
    if (member && member->owes) {
      waiting.push_back({member->name, member->granted_wall, owed(*member)});
    }
  }
  return waiting;
}

std::vector<LockstepStatus::Participant> LockstepSession::participants() const {
  std::vector<MemberId> ids;
  for (const auto& [id, member] : members_) {
    if (!member.departing) {
      ids.push_back(id);
    }
  }
  std::sort(ids.begin(), ids.end(), [this](auto a, auto b) { return rounds_.before(a, b); });
  std::vector<LockstepStatus::Participant> participants;
  for (const MemberId id : ids) {
    const Member& member = members_.at(id);
    const LockstepRounds::MemberState& state = *rounds_.find(id);
    participants.push_back({id, member.name, member.node_uri, state.rank,
                            state.next == kNever ? std::nullopt : std::optional(state.next),
                            state.open, member.waits_for, state.knocked, state.mail.size(),
                            state.owes});
  }
  return participants;
}

LockstepStatus LockstepSession::status() const {
  LockstepStatus status;
  status.phase = phase();
  status.time = rounds_.now();
  status.microstep = rounds_.microstep();
  status.paused = rounds_.paused();
  if (!rounds_.ended()) {
    status.waiting_for = waitingFor();
  }
  status.participants = participants();
  status.not_repeatable = not_repeatable_;
  status.degraded = degraded_;
  status.reason = standstill();
  status.limit = rounds_.limit();
  status.run_until = rounds_.target();
  status.rounds = rounds_.rounds();
  status.leaps = rounds_.leaps();
  status.messages = router_.messages();
  return status;
}

}  // namespace move_base_abstract
