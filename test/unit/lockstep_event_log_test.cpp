// The event log of a run: its lines, their order, and labels.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "lockstep/session.h"
#include "lockstep_client.h"

namespace move_base_abstract::lockstep_event_log_test {
namespace {

using Texts = std::vector<std::string>;

TEST(EventLog, IsSortedWithinARoundByRankRobotNameAndNumber) {
  Stage stage(named({"/fleet_10", "/fleet_9", "/first"}));
  stage.join(1, "/fleet_10", 1);
  stage.join(2, "/fleet_9", 1);
  stage.join(3, "/first", 0);
  const auto log = [](std::uint32_t sub, const char* robot) {
    return wire::Log{sub, robot, "seen", "[1,2]"};
  };
  for (const ConnectionId id : {1U, 2U, 3U}) {
    stage.grant(id);
  }
  stage.report(1, kNever, {log(1, "d"), log(1, "e"), log(0, "b")});
  stage.report(2, kNever, {log(0, "a"), log(1, "c")});
  EXPECT_EQ(lines(stage.session), Texts{});
  stage.report(3, kNever, {log(7, "first")});
  EXPECT_EQ(lines(stage.session),
            (Texts{"1000 first seen [1,2]", "1000 a seen [1,2]", "1000 b seen [1,2]",
                   "1000 c seen [1,2]", "1000 d seen [1,2]", "1000 e seen [1,2]"}));
}

TEST(EventLog, CanHaveEveryMessageAndCallWithAHashOfItsBytes) {
  LockstepSettings settings = named({"/a", "/b"});
  settings.log_messages = true;
  Pair pair(settings);
  pair.report(1, kNever, {advertise(1, "/x"), subscribe(1, "/x"), wire::Serve{1, 0, "/s"}});
  pair.report(2, kNever, {subscribe(1, "/x"), wire::Call{0, 0, "/s", "foobar"}});
  pair.grant(1);
  pair.grant(2);
  pair.report(1, kNever, {wire::Send{1, 0, 0, ""}, wire::Response{2, 0, true, "a"}});
  pair.report(2, kNever, {wire::Call{1, 0, "/no\"body", ""}});
  EXPECT_EQ(lines(pair.session),
            (Texts{"1000 /s call [\"/b\",\"/a\",6,\"85944171f73967e8\"]",
                   "1000 /x message [\"/a\",\"/a\",\"/b\",0,\"cbf29ce484222325\"]",
                   "1000 /s response [\"/a\",\"/b\",1,1,\"af63dc4c8601ec8c\"]",
                   "1000 /no\"body response [\"\",\"/b\",2,0,\"cbf29ce484222325\"]"}));
}

TEST(EventLog, NamesAreWrittenAsJson) {
  LockstepSettings settings = named({"/a\\b\"c", "/d"});
  settings.log_messages = true;
  Stage stage(settings);
  stage.join(1, "/a\\b\"c");
  stage.join(2, "/d");
  stage.grant(1);
  stage.grant(2);
  stage.report(1, kNever, {advertise(1, "/x\\"), wire::Call{0, 0, "/nobody", ""}});
  stage.report(2, kNever, {subscribe(1, "/x\\")});
  stage.grant(1);
  stage.grant(2);
  stage.report(1, kNever, {wire::Send{1, 0, 0, ""}});
  stage.report(2, kNever);
  EXPECT_EQ(lines(stage.session),
            (Texts{R"(1000 /nobody response ["","/a\\b\"c",2,0,"cbf29ce484222325"])",
                   R"(1000 /x\ message ["/a\\b\"c","/d",0,"cbf29ce484222325"])"}));
}

TEST(EventLog, NotesLabelTheRun) {
  Pair pair;
  pair.report(1, kNever,
              {wire::Note{wire::NoteKind::kNotRepeatable, "measured charges"},
               wire::Note{wire::NoteKind::kNotRepeatable, "measured charges"},
               wire::Note{wire::NoteKind::kDegraded, "a sensor failed"},
               wire::Note{wire::NoteKind::kWaitsFor, "rospy.spin"}});
  pair.report(2, kNever);
  const LockstepStatus status = pair.session.status();
  EXPECT_EQ(status.not_repeatable, Texts{"'/a': measured charges"});
  EXPECT_EQ(status.degraded, Texts{"'/a': a sensor failed"});
  EXPECT_EQ(status.participants[0].waits_for, "rospy.spin");
}

// ---- one fleet, however many processes
// -------------------------------------------------------------

/** @brief A coordinator and robots in one or several processes, all with the same duties. */
class Fleet {
 public:
  /** @param processes which robots run together. */
  explicit Fleet(std::vector<std::vector<std::uint32_t>> processes)
      : processes_(std::move(processes)), stage_(named(names(processes_.size()))) {
    stage_.join(1, "/coordinator");
    for (std::size_t k = 0; k < processes_.size(); ++k) {
      stage_.join(k + 2, names(processes_.size())[k + 1], 1);
    }
  }

  Texts run() {
    for (bool busy = true; busy;) {
      busy = false;
      // The last ones first: the order of reports must not matter.
      for (ConnectionId id = processes_.size() + 1; id >= 1; --id) {
        while (auto grant = stage_.grant(id)) {
          busy = true;
          id == 1 ? coordinate(grant->grant) : drive(id, grant->grant);
        }
      }
    }
    return lines(stage_.session);
  }

 private:
  static std::vector<std::string> names(std::size_t processes) {
    std::vector<std::string> names{"/coordinator"};
    for (std::size_t k = 1; k <= processes; ++k) {
      names.push_back("/fleet_" + std::to_string(k));
    }
    return names;
  }

  static constexpr std::uint32_t kRobots = 12;

  void coordinate(const wire::Grant& grant) {
    std::vector<wire::ReportItem> items;
    if (grant.round == 1) {
      items = {advertise(1, "/goal"), subscribe(2, "/result")};
    }
    for (const wire::GrantItem& item : grant.items) {
      if (const auto* result = std::get_if<wire::Deliver>(&item)) {
        items.push_back(wire::Log{0, result->payload, "done", "[]"});
        // Whom it sends next depends on who came first.
        sent_ = (sent_ * 7 + static_cast<std::uint32_t>(result->payload[0])) % 1000;
        if (++goals_ < 60) {
          texts_.push_back(std::string(1, static_cast<char>('a' + (sent_ % kRobots))));
          items.push_back(wire::Send{1, 0, 0, texts_.back()});
        }
      }
    }
    if (grant.time_ns == kSecond && grant.microstep == 2) {  // the links are there
      for (std::uint32_t robot = 0; robot < kRobots; ++robot) {
        texts_.push_back(std::string(1, static_cast<char>('a' + robot)));
        items.push_back(wire::Send{1, 0, 0, texts_.back()});
      }
    }
    const bool wait = grant.time_ns == kSecond && grant.microstep < 2;
    stage_.report(1, wait ? kSecond : kNever, items);
  }

  void drive(ConnectionId id, const wire::Grant& grant) {
    std::vector<wire::ReportItem> items;
    if (grant.round == 1) {
      items = {subscribe(1, "/goal"), advertise(2, "/result")};
    }
    auto& due = due_[id];
    for (const wire::GrantItem& item : grant.items) {
      if (const auto* goal = std::get_if<wire::Deliver>(&item)) {
        const auto robot = static_cast<std::uint32_t>(goal->payload[0] - 'a');
        const auto& own = processes_[id - 2];
        if (std::find(own.begin(), own.end(), robot) != own.end()) {
          items.push_back(wire::Log{robot, goal->payload, "goal", "[]"});
          due.insert({grant.time_ns + (1 + robot % 3) * kSecond, robot});  // many at one instant
        }
      }
    }
    while (!due.empty() && due.begin()->first <= grant.time_ns) {
      const std::uint32_t robot = due.begin()->second;
      due.erase(due.begin());
      texts_.push_back(std::string(1, static_cast<char>('a' + robot)));
      items.push_back(wire::Log{robot, texts_.back(), "arrived", "[]"});
      items.push_back(wire::Send{2, robot, 0, texts_.back()});
    }
    stage_.report(id, due.empty() ? kNever : due.begin()->first, items);
  }

  std::vector<std::vector<std::uint32_t>> processes_;
  Stage stage_;
  std::map<ConnectionId, std::set<std::pair<Nanoseconds, std::uint32_t>>> due_;
  std::deque<std::string> texts_;  // that items point to
  std::uint32_t sent_ = 0;
  int goals_ = 0;
};

TEST(OneFleet, HasTheSameLogInOneProcessAsInThree) {
  const Texts one = Fleet({{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}}).run();
  EXPECT_GT(one.size(), 150U);
  EXPECT_EQ(Fleet({{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}}).run(), one);
  EXPECT_EQ(Fleet({{11, 3, 5}, {4, 0}, {7, 6, 9}, {1, 2, 8, 10}}).run(), one);
}

}  // namespace
}  // namespace move_base_abstract::lockstep_event_log_test
