// Participants of a session that a test plays by hand.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lockstep/session.h"
#include "refusal.h"

namespace move_base_abstract {

constexpr Nanoseconds kSecond = kNanosecondsPerSecond;

inline LockstepSettings named(std::vector<std::string> names) {
  LockstepSettings settings;
  settings.participants = std::move(names);
  return settings;
}

/** @brief A grant whose texts live as long as it does. */
struct ClientGrant {
  std::string frame;
  wire::Grant grant;
};

/** @brief A session, the wall clock, and what each connection got. */
class Stage {
 public:
  explicit Stage(const LockstepSettings& settings) : session(settings, 0) {}

  /** @brief A participant says HELLO over connection @p id. */
  void join(ConnectionId id, const std::string& name, std::int32_t rank = 0, bool declared = true) {
    session.connect(id, wall);
    frame(id, wire::Hello{wire::kProtocol, name, "http://host:1/", rank, declared, id, secret});
  }

  void frame(ConnectionId id, const wire::ParticipantFrame& frame) {
    bytes(id, wire::encode(frame));
  }

  void bytes(ConnectionId id, const std::string& bytes) {
    session.received(id, bytes, wall);
    poll();
  }

  void poll() {
    for (const LockstepSession::Output& output : session.poll(wall)) {
      buffers_[output.connection].append(output.bytes);
      closed[output.connection] = closed[output.connection] || output.close;
      while (const auto frame = buffers_[output.connection].next()) {
        keep(output.connection, std::string(*frame));
      }
    }
    for (LockstepMessage& message : session.takeMessages()) {
      messages.push_back(std::move(message));
    }
  }

  /** @return the next grant of @p id that was not asked for before, if there is one. */
  std::optional<ClientGrant> grant(ConnectionId id) {
    auto& grants = grants_[id];
    if (grants.empty()) {
      return std::nullopt;
    }
    ClientGrant next;
    next.frame = std::move(grants.front());
    grants.pop_front();
    next.grant = std::get<wire::Grant>(wire::decodeFromMaster(next.frame));
    round_[id] = next.grant.round;
    return next;
  }

  /** @return "time[ms]+microstep" of the next grant, or "none". */
  std::string point(ConnectionId id) {
    const auto next = grant(id);
    return next ? std::to_string(next->grant.time_ns / 1'000'000) + "+" +
                      std::to_string(next->grant.microstep)
                : "none";
  }

  /** @brief Report of the latest grant that was asked for. */
  void report(ConnectionId id, Nanoseconds next, std::vector<wire::ReportItem> items = {},
              std::uint32_t open = 0) {
    frame(id, wire::Report{round_[id], false, next, open, std::move(items)});
  }

  std::uint64_t round(ConnectionId id) const { return round_.at(id); }

  void leave(ConnectionId id) { frame(id, wire::Report{round_[id], true, kNever, 0, {}}); }

  void cut(ConnectionId id) {
    session.disconnected(id, wall);
    poll();
  }

  /** @return whether a message of at least @p level contains @p text. */
  bool said(const std::string& text,
            LockstepMessage::Level level = LockstepMessage::Level::kDebug) const {
    for (const LockstepMessage& message : messages) {
      if (message.level >= level && message.text.find(text) != std::string::npos) {
        return true;
      }
    }
    return false;
  }

  std::string phase() const { return phaseName(session.phase()); }

  LockstepSession session;
  Nanoseconds wall = 0;
  std::string secret;  // that join() gives
  std::map<ConnectionId, bool> closed;
  std::map<ConnectionId, std::string> end;                   // the reason that END gave
  std::map<ConnectionId, std::vector<std::string>> members;  // of MEMBER, "-id" of GONE
  // of WELCOME
  std::map<ConnectionId, MemberId> ids;
  std::map<ConnectionId, std::int32_t> ranks;
  std::map<ConnectionId, std::vector<std::string>> excluded;
  std::vector<LockstepMessage> messages;

 private:
  void keep(ConnectionId id, std::string frame) {
    const wire::MasterFrame decoded = wire::decodeFromMaster(frame);
    if (std::holds_alternative<wire::Grant>(decoded)) {
      grants_[id].push_back(std::move(frame));
    } else if (const auto* bye = std::get_if<wire::End>(&decoded)) {
      end[id] = bye->reason;
    } else if (const auto* welcome = std::get_if<wire::Welcome>(&decoded)) {
      ids[id] = welcome->own_id;
      ranks[id] = welcome->rank;
      excluded[id].assign(welcome->excluded_topics.begin(), welcome->excluded_topics.end());
    } else if (const auto* member = std::get_if<wire::Member>(&decoded)) {
      members[id].push_back(std::to_string(member->id) + " " + std::string(member->name));
    } else if (const auto* gone = std::get_if<wire::Gone>(&decoded)) {
      members[id].push_back("-" + std::to_string(gone->id));
    }
  }

  std::map<ConnectionId, wire::FrameBuffer> buffers_;
  std::map<ConnectionId, std::deque<std::string>> grants_;
  std::map<ConnectionId, std::uint64_t> round_;
};

/** @brief Two participants that have got their first grants. */
struct Pair : Stage {
  explicit Pair(LockstepSettings settings = named({"/a", "/b"})) : Stage(settings) {
    join(1, "/a");
    join(2, "/b");
    grant(1);
    grant(2);
  }
};

/** @brief One participant that has started and reported that it wants to wake up at @p next. */
struct Alone : Stage {
  explicit Alone(Nanoseconds next, LockstepSettings settings = named({"/a"})) : Stage(settings) {
    join(1, "/a");
    grant(1);
    report(1, next);
  }
};

/** @return "time[ms]+microstep: item item" of each grant that @p id got since the last call. */
template <typename TextOf>
std::vector<std::string> grants(Stage& stage, ConnectionId id, const TextOf& text_of) {
  std::vector<std::string> texts;
  while (const auto next = stage.grant(id)) {
    std::string line = std::to_string(next->grant.time_ns / 1'000'000) + "+" +
                       std::to_string(next->grant.microstep) + ":";
    for (const wire::GrantItem& item : next->grant.items) {
      const std::string text = text_of(item);
      line += text.empty() ? "" : " " + text;
    }
    texts.push_back(line);
  }
  return texts;
}

/** @return the lines of the event log since the last call, their times in ms. */
inline std::vector<std::string> lines(LockstepSession& session) {
  std::vector<std::string> lines;
  for (const LockstepLogEntry& entry : session.takeLog()) {
    lines.push_back(std::to_string(entry.time / 1'000'000) + " " + entry.robot + " " + entry.kind +
                    " " + entry.values);
  }
  return lines;
}

inline wire::Advertise advertise(std::uint32_t topic, std::string_view name,
                                 std::string_view md5 = "md5", bool latched = false) {
  return {topic, 0, name, "test/Type", md5, latched, "definition"};
}

inline wire::Subscribe subscribe(std::uint32_t topic, std::string_view name,
                                 std::string_view md5 = "md5") {
  return {topic, 0, name, md5};
}

}  // namespace move_base_abstract
