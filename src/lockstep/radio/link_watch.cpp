#include "link_watch.h"

#include <algorithm>

namespace move_base_abstract::radio {
namespace {

constexpr int kStepsAtOnce = 64;  // of a search, as a drive may be called off

}  // namespace

bool LinkWatch::isUp(HostId one, HostId other) const {
  const auto found = links_.find(std::minmax(one, other));
  return found != links_.end() && found->second.is_up;
}

void LinkWatch::meet(Nanoseconds now) {
  while (met_ < hosts_.count()) {
    ++met_;
    for (HostId other = 1; other < met_; ++other) {
      if (const LinkRule* rule = hosts_.rule(other, met_)) {
        const Pair pair{other, met_};
        Link& link = links_[pair];
        link.rule = rule;
        link.is_up = !upAt(pair, link, now);
        change(pair, link, now);  // its first state is reported, too
        search(pair, link, now);
      }
    }
  }
}

void LinkWatch::moved(HostId host, Nanoseconds now) {
  for (HostId other = 1; other <= met_; ++other) {
    const Pair pair = std::minmax(host, other);
    const auto found = links_.find(pair);
    if (found != links_.end()) {
      if (upAt(pair, found->second, now) != found->second.is_up) {
        change(pair, found->second, now);
      }
      search(pair, found->second, now);
    }
  }
}

bool LinkWatch::upAt(const Pair& pair, const Link& link, Nanoseconds now) const {
  return hosts_.reach(*link.rule, pair.first, pair.second, now).is_up;
}

/** @brief Find the next change after @p from, as both hosts move now. */
void LinkWatch::search(const Pair& pair, Link& link, Nanoseconds from) {
  const Nanoseconds end = std::max(hosts_.standsFrom(pair.first), hosts_.standsFrom(pair.second));
  Nanoseconds before = from;
  for (int step = 0; before < end; ++step) {
    if (step == kStepsAtOnce) {
      return setDue(pair, link, before, false);
    }
    const Nanoseconds after = std::min(nextLookAfter(before), end);
    if (upAt(pair, link, after) != link.is_up) {
      return setDue(pair, link, changeBetween(pair, link, before, after), true);
    }
    before = after;
  }
  setDue(pair, link, kNever, false);
}

Nanoseconds LinkWatch::changeBetween(const Pair& pair, const Link& link, Nanoseconds before,
                                     Nanoseconds after) const {
  while (after - before > 1) {
    const Nanoseconds middle = before + (after - before) / 2;
    (upAt(pair, link, middle) == link.is_up ? before : after) = middle;
  }
  return after;
}

void LinkWatch::setDue(const Pair& pair, Link& link, Nanoseconds due, bool changes) {
  due_.erase({link.due, pair});
  link.due = due;
  link.changes = changes;
  if (due != kNever) {
    due_.insert({due, pair});
  }
}

void LinkWatch::change(const Pair& pair, Link& link, Nanoseconds at) {
  link.is_up = !link.is_up;
  changes_.push_back({at, pair.first, pair.second, link.is_up});
}

void LinkWatch::advance(Nanoseconds now) {
  while (next() <= now) {
    const auto [at, pair] = *due_.begin();
    Link& link = links_.at(pair);
    if (link.changes) {
      change(pair, link, at);
    }
    search(pair, link, at);
  }
}

std::vector<LinkWatch::Change> LinkWatch::take() { return std::exchange(changes_, {}); }

}  // namespace move_base_abstract::radio
