#include "radio.h"

#include <algorithm>

#include "draws.h"

namespace move_base_abstract::radio {
namespace {

using Kind = Radio::Outcome::Kind;
__extension__ using Wide = __int128;
constexpr Nanoseconds kLongestRetry = 60 * kNanosecondsPerSecond;  // RFC 6298, 2.5

/** @return how long it takes to send @p bytes at @p rate [bit/s], rounded up. */
Nanoseconds sendingTime(std::size_t bytes, std::int64_t rate) {
  const Wide bits = static_cast<Wide>(bytes) * 8 * kNanosecondsPerSecond;
  return rate == 0 ? 0 : static_cast<Nanoseconds>((bits + rate - 1) / rate);
}

/** @return the time from a failed attempt to the next: doubled each time (RFC 6298, 5.5). */
Nanoseconds backOff(Nanoseconds first, std::uint32_t attempt) {
  Nanoseconds wait = first;
  for (std::uint32_t k = 0; k < attempt && wait < kLongestRetry; ++k) {
    wait *= 2;
  }
  return std::max(first, std::min(wait, kLongestRetry));
}

}  // namespace

Radio::Channel& Radio::channel(HostId from, HostId to) {
  const auto [known, fresh] = numbers_.try_emplace({from, to}, channels_.size());
  if (fresh) {
    channels_.push_back({});
    Channel& made = channels_.back();
    made.from = from;
    made.to = to;
    made.rule = hosts_.rule(from, to);
    made.key = linkKey(hosts_.network().seed, hosts_.name(from), hosts_.name(to));
  }
  return channels_[known->second];
}

Radio::Outcome Radio::send(HostId from, HostId to, std::size_t bytes, Ticket ticket,
                           Nanoseconds now) {
  Channel& on = channel(from, to);
  if (on.rule == nullptr) {
    return {Kind::kLost, now, lost_by::kNoLink};
  }
  if (isFull(on, bytes, now)) {
    return {Kind::kLost, now, lost_by::kBuffer};
  }
  Waiting message{ticket, bytes, on.number++, 0};
  if (on.waiting.empty()) {
    const Outcome outcome = attempt(on, message, now);
    if (outcome.kind != Kind::kWaits) {
      return outcome;
    }
  }
  on.waiting.push_back(message);
  on.waiting_bytes += bytes;
  return {Kind::kWaits, now, nullptr};
}

bool Radio::isFull(const Channel& on, std::size_t bytes, Nanoseconds now) const {
  if (on.rule->buffer == 0) {
    return false;
  }
  const Nanoseconds left = std::max<Nanoseconds>(on.free - now, 0);
  const Wide bits = static_cast<Wide>(left) * on.rule->rate / kNanosecondsPerSecond +
                    8 * static_cast<Wide>(on.waiting_bytes);
  return bits + 8 * static_cast<Wide>(bytes) > 8 * static_cast<Wide>(on.rule->buffer);
}

Radio::Outcome Radio::attempt(Channel& on, Waiting& message, Nanoseconds now) {
  const Hosts::Reach reach = hosts_.reach(*on.rule, on.from, on.to, now);
  if (!reach.is_up) {
    return fail(on, message, reach.is_placed ? lost_by::kRange : lost_by::kPlace, now);
  }
  on.free = addSaturated(std::max(now, on.free), sendingTime(message.bytes, on.rule->rate));
  if (happens(draw(on.key, message.number, message.attempt, Purpose::kLoss), reach.loss)) {
    return fail(on, message, lost_by::kLoss, on.free);
  }
  const Nanoseconds delay = between(draw(on.key, message.number, message.attempt, Purpose::kDelay),
                                    on.rule->delay_low, on.rule->delay_high);
  on.latest = std::max(on.latest, addSaturated(on.free, delay));  // nothing overtakes
  return {Kind::kArrives, on.latest, nullptr};
}

Radio::Outcome Radio::fail(Channel& on, Waiting& message, const char* reason, Nanoseconds now) {
  ++message.attempt;
  const bool retries = on.rule->lost == OnLoss::kRetry;
  if (on.rule->lost == OnLoss::kDrop || (retries && message.attempt >= on.rule->attempts)) {
    return {Kind::kLost, now, reason};
  }
  if (retries) {
    setLook(on, addSaturated(now, backOff(on.rule->retry, message.attempt - 1)));
  } else if (reason == lost_by::kLoss) {
    setLook(on, addSaturated(now, on.rule->retry));
  } else {
    const Nanoseconds moves_until = std::max(hosts_.standsFrom(on.from), hosts_.standsFrom(on.to));
    on.sleeps = now >= moves_until;
    setLook(on, on.sleeps ? kNever : nextLookAfter(now));
  }
  return {Kind::kWaits, now, nullptr};
}

void Radio::setLook(Channel& on, Nanoseconds look) {
  const std::size_t number = numbers_.at({on.from, on.to});
  looks_.erase({on.look, number});
  on.look = look;
  if (look != kNever) {
    looks_.insert({look, number});
  }
}

void Radio::moved(HostId host, Nanoseconds now) {
  for (Channel& on : channels_) {
    if (on.sleeps && (on.from == host || on.to == host)) {
      on.sleeps = false;
      setLook(on, nextLookAfter(now));
    }
  }
}

std::vector<Radio::Decided> Radio::look(Nanoseconds now) {
  std::vector<Decided> decided;
  while (nextLook() <= now) {
    Channel& on = channels_[looks_.begin()->second];
    setLook(on, kNever);
    while (!on.waiting.empty()) {
      Waiting& message = on.waiting.front();
      const Outcome outcome = attempt(on, message, now);
      if (outcome.kind == Kind::kWaits) {
        break;
      }
      decided.push_back({message.ticket, outcome});
      on.waiting_bytes -= message.bytes;
      on.waiting.pop_front();
    }
  }
  return decided;
}

}  // namespace move_base_abstract::radio
