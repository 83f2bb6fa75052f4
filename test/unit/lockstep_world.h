// A session with scripted participants, whose bytes arrive in an order that the test chooses.
#pragma once

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "lockstep/session.h"
#include "lockstep_model.h"
#include "lockstep_script.h"

namespace move_base_abstract {

/** @brief What may happen in a test besides reports. */
struct WorldOptions {
  int grants = 10;       // to each participant; after these it only listens
  bool pieces = false;   // frames are cut anywhere, and it is not polled after each
  bool knocks = false;   // at any time
  bool deaths = false;   // at any time, in the middle of a frame too
  bool leaving = false;  // with a report
  bool stops = false;    // it stops after rounds, and goes on some time later
};

/** @return a number below its argument; whoever makes the choices decides the order of arrival. */
using Choose = std::function<std::size_t(std::size_t)>;

class World {
 public:
  World(std::vector<ScriptNode> nodes, std::uint64_t seed, const WorldOptions& options,
        Choose choose)
      : nodes_(std::move(nodes)),
        options_(options),
        choose_(std::move(choose)),
        session_(settings(nodes_), 0),
        model_(nodes_, kStart),
        wires_(nodes_.size()) {
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      scripts_.emplace_back(k, nodes_[k], seed, options.grants);
      scripts_.back().may_leave = options.leaving;
      wires_[k].out = wire::encode(wire::ParticipantFrame(
          wire::Hello{wire::kProtocol, nodes_[k].name, "http://" + nodes_[k].name, nodes_[k].rank,
                      true, k + 1, ""}));
      session_.connect(k + 1, 0);
    }
  }

  /** @return the first thing that was wrong, as "check: what"; empty: nothing. */
  std::string run() {
    // A stall or a loop would go on for ever; a right run is far shorter than this.
    for (int k = 0; k < 20'000 && violation_.empty(); ++k) {
      if (!arrive() && !poll()) {
        finish();
        return violation_;
      }
    }
    violate("endless", "the run does not come to its end");
    return violation_;
  }

  const std::string& transcript() const { return transcript_; }
  int rounds() const { return rounds_; }
  std::uint64_t stops() const { return session_.status().stops; }

 private:
  static constexpr Nanoseconds kStart = kNanosecondsPerSecond;

  struct Wire {
    std::string out;  // on its way to the session
    wire::FrameBuffer seen;
    wire::FrameBuffer in;
    bool open = true;
  };

  static LockstepSettings settings(const std::vector<ScriptNode>& nodes) {
    LockstepSettings settings;
    for (const ScriptNode& node : nodes) {
      settings.participants.push_back(node.name);
    }
    return settings;
  }

  /** @brief Something arrives at the session. @return whether there was anything. */
  bool arrive() {
    std::vector<std::size_t> ready;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      if (!wires_[k].out.empty()) {
        ready.push_back(k);
      }
    }
    if (ready.empty()) {
      return false;
    }
    const std::size_t node = ready[ready.size() > 1 ? choose_(ready.size()) : 0];
    disturb(node);
    pass(node);
    if (!options_.pieces || choose_(2) == 0) {
      poll();
    }
    return true;
  }

  void disturb(std::size_t node) {
    if (!model_.started()) {
      return;
    }
    if (options_.knocks && choose_(8) == 0 && wires_[node].open) {
      wires_[node].out += wire::encode(wire::ParticipantFrame(wire::Knock{}));
    }
    if (options_.deaths && deaths_ + 1 < nodes_.size() && choose_(40) == 0) {
      ++deaths_;
      const std::size_t part = choose_(wires_[node].out.size() + 1);
      wires_[node].out.resize(part);
      pass(node, part);
      wires_[node].open = false;
      session_.disconnected(node + 1, 0);
      model_.lost(node);
    }
  }

  void pass(std::size_t node) {
    std::string& out = wires_[node].out;
    if (out.empty()) {
      return;
    }
    pass(node, options_.pieces ? 1 + choose_(out.size()) : frameSize(out));
  }

  static std::size_t frameSize(const std::string& bytes) {
    std::size_t size = 0;
    for (std::size_t k = 4; k-- > 0;) {
      size = (size << 8U) | static_cast<unsigned char>(bytes[k]);
    }
    return size + 4;
  }

  void pass(std::size_t node, std::size_t size) {
    Wire& wire = wires_[node];
    const std::string bytes = wire.out.substr(0, size);
    wire.out.erase(0, size);
    session_.received(node + 1, bytes, 0);
    wire.seen.append(bytes);
    while (const auto frame = wire.seen.next()) {
      if (wire.open) {
        model_.got(node, *frame);
      }
    }
  }

  /** @return whether anything came out of it. */
  bool poll() {
    stopOrGoOn();
    ExpectedRound got;
    std::vector<std::pair<std::size_t, std::string>> grants;
    wall_ += options_.stops && model_.started() ? kNanosecondsPerSecond : 0;
    for (const LockstepSession::Output& output : session_.poll(wall_)) {
      read(output, got, grants);
    }
    if (session_.phase() == LockstepPhase::kStopped) {
      if (!grants.empty()) {
        violate("stop", "it grants while it stands");
      }
      return true;
    }
    const Nanoseconds time = model_.time();
    const bool working = model_.anyOwes();
    const ExpectedRound expected = model_.decide();
    compare(expected, got, time, working);
    compareLog();
    if (grants.empty() || !violation_.empty()) {
      return false;
    }
    ++rounds_;
    transcript_ += got.text();
    for (const auto& [node, frame] : grants) {
      const wire::MasterFrame decoded = wire::decodeFromMaster(frame);
      if (wires_[node].open) {
        wires_[node].out += scripts_[node].answer(std::get<wire::Grant>(decoded));
      }
    }
    return true;
  }

  void stopOrGoOn() {
    if (!options_.stops || choose_(3) != 0) {
      return;
    }
    StopCondition condition;
    condition.count = choose_(3);
    if (choose_(3) == 0) {
      condition.what = StopCondition::What::kRow;
      condition.count = choose_(5);
    }
    if (choose_(2) == 0) {
      session_.stopWhen(condition);
    } else if (session_.phase() == LockstepPhase::kStopped) {
      session_.resume();
    }
  }

  void read(const LockstepSession::Output& output, ExpectedRound& got,
            std::vector<std::pair<std::size_t, std::string>>& grants) {
    const std::size_t node = output.connection - 1;
    wires_[node].in.append(output.bytes);
    while (const auto frame = wires_[node].in.next()) {
      const wire::MasterFrame decoded = wire::decodeFromMaster(*frame);
      if (const auto* grant = std::get_if<wire::Grant>(&decoded)) {
        grants.push_back({node, std::string(*frame)});
        got.time = grant->time_ns;
        got.microstep = grant->microstep;
        auto& items = got.grants[node];
        for (const wire::GrantItem& item : grant->items) {
          items.push_back(itemText(item, [](std::uint32_t id) { return id - 1; }));
        }
      } else if (std::holds_alternative<wire::End>(decoded)) {
        violate("dropped", std::string(std::get<wire::End>(decoded).reason));
      }
    }
  }

  void compare(const ExpectedRound& expected, const ExpectedRound& got, Nanoseconds before,
               bool working) {
    const std::string both = "expected " + expected.text() + "got " + got.text();
    if (got.grants.empty() || expected.grants.empty()) {
      if (!expected.grants.empty()) {
        violate("stall", both);
      } else if (!got.grants.empty()) {
        violate(working ? "barrier" : "start", both);
      }
    } else if (got.time < before) {
      violate("time back", both);
    } else if (expected.time == before && got.time > before) {
      violate("undelivered", both);
    } else if (got.time != expected.time) {
      violate("leap", both);
    } else if (got.microstep != expected.microstep) {
      violate("microstep", both);
    } else {
      compareGrants(expected, got, both);
    }
  }

  void compareGrants(const ExpectedRound& expected, const ExpectedRound& got,
                     const std::string& both) {
    for (const auto& [node, items] : got.grants) {
      if (expected.grants.count(node) == 0) {
        return violate("extra grant", both);
      }
    }
    for (const auto& [node, items] : expected.grants) {
      if (got.grants.count(node) == 0) {
        return violate("missing grant", both);
      }
      const auto& others = got.grants.at(node);
      if (items == others) {
        continue;
      }
      const bool same =
          std::is_permutation(items.begin(), items.end(), others.begin(), others.end());
      return violate(same ? "mail order" : "mail", both);
    }
  }

  void compareLog() {
    for (const LockstepLogEntry& line : session_.takeLog()) {
      const std::string text =
          std::to_string(line.time) + " " + line.robot + " " + line.kind + " " + line.values;
      transcript_ += text + "\n";
      if (logged_ >= model_.log().size() || model_.log()[logged_] != text) {
        violate("log", text);
      }
      ++logged_;
    }
  }

  void finish() {
    if (logged_ != model_.log().size()) {
      violate("log", "lines are missing");
    }
    if (model_.anyOwes()) {
      violate("script", "a participant did not report");
    }
    const LockstepPhase phase = session_.phase();
    if (phase != LockstepPhase::kIdle) {
      violate("stall", std::string("at the end the phase is ") + phaseName(phase));
    }
  }

  void violate(const std::string& check, const std::string& what) {
    if (violation_.empty()) {
      violation_ = check + ": " + what;
    }
  }

  const std::vector<ScriptNode> nodes_;
  const WorldOptions options_;
  const Choose choose_;
  LockstepSession session_;
  LockstepModel model_;
  std::vector<Wire> wires_;
  std::vector<Script> scripts_;
  std::size_t deaths_ = 0;
  Nanoseconds wall_ = 0;
  std::size_t logged_ = 0;
  int rounds_ = 0;
  std::string transcript_;
  std::string violation_;
};

/** @brief Choices at random, but the same for the same seed. */
inline Choose randomChoices(std::uint64_t seed) {
  return [random = std::mt19937_64(seed)](std::size_t end) mutable {
    return static_cast<std::size_t>(random() % end);
  };
}

/** @brief Goes through all sequences of choices, one run after the other. */
class AllChoices {
 public:
  Choose choices() {
    at_ = 0;
    return [this](std::size_t end) {
      if (at_ == path_.size()) {
        path_.push_back({0, end});
      }
      return path_[at_++].first;
    };
  }

  /** @return whether there is another sequence. */
  bool advance() {
    while (!path_.empty() && path_.back().first + 1 == path_.back().second) {
      path_.pop_back();
    }
    if (path_.empty()) {
      return false;
    }
    ++path_.back().first;
    return true;
  }

 private:
  std::vector<std::pair<std::size_t, std::size_t>> path_;  // choice, number of choices
  std::size_t at_ = 0;
};

}  // namespace move_base_abstract
