// Random runs with a lookahead, against plain arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lockstep_walkers.h"

namespace move_base_abstract::lockstep_windows_random_test {
namespace {

/** @return the log of the run by plain arithmetic: a queue of exact arrivals, no windows. */
std::vector<std::string> byHand(std::vector<Actor> actors) {
  // By instant; what arrives at one: in the order in which it was sent.
  std::map<std::pair<Nanoseconds, std::size_t>, std::vector<Message>> arrivals;
  std::vector<std::string> log;
  while (true) {
    Nanoseconds now = kNever;
    for (const Actor& actor : actors) {
      now = actor.ticks > 0 ? std::min(now, actor.next) : now;
    }
    now = arrivals.empty() ? now : std::min(now, arrivals.begin()->first.first);
    if (now == kNever) {
      return log;
    }
    for (std::size_t k = 0; k < actors.size(); ++k) {
      Actor& actor = actors[k];
      std::vector<Message> sent;
      for (const Message& heard : arrivals[{now, k}]) {
        log.push_back(line(now, actor.name, heard));
        sent.push_back(relayed(heard, actor));
      }
      arrivals.erase({now, k});
      if (actor.ticks > 0 && actor.next == now) {
        sent.push_back("1 " + actor.name.substr(1) + "-" + std::to_string(actor.made++));
        actor.next += actor.period;
        --actor.ticks;
      }
      for (const Message& message : sent) {
        for (std::size_t other = 0; other < actors.size() && !message.empty(); ++other) {
          arrivals[{now + kAhead, other}].push_back(message);
        }
      }
    }
  }
}

TEST(Windows, RandomRunsAreThoseOfPlainArithmeticHoweverFarEachGoesByItself) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const std::vector<Actor> actors = randomActors(seed);
    const std::vector<std::string> expected = byHand(actors);
    ASSERT_GT(expected.size(), 20U);
    for (std::uint64_t order = 0; order < 2; ++order) {
      ASSERT_EQ(Walkers(actors, seed * 2 + order).run(), expected) << seed << " " << order;
    }
  }
}

}  // namespace
}  // namespace move_base_abstract::lockstep_windows_random_test
