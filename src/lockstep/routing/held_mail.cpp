#include "held_mail.h"

#include <algorithm>
#include <iterator>

namespace move_base_abstract {

void HeldMail::add(Nanoseconds due, Held held) {
  const std::pair place(due, count_++);
  if (held.ticket != 0) {
    waiting_.emplace(held.ticket, place);
  }
  mail_.emplace(place, std::move(held));
}

std::vector<Held> HeldMail::take(Nanoseconds now) {
  std::vector<Held> taken;
  while (!mail_.empty() && mail_.begin()->first.first <= now) {
    taken.push_back(std::move(mail_.begin()->second));
    mail_.erase(mail_.begin());
  }
  return taken;
}

std::optional<Held> HeldMail::takeWaiting(std::uint64_t ticket) {
  const auto place = waiting_.find(ticket);
  if (place == waiting_.end()) {
    return std::nullopt;
  }
  auto node = mail_.extract(place->second);
  waiting_.erase(place);
  node.mapped().ticket = 0;
  return std::move(node.mapped());
}

std::vector<Held> HeldMail::drop(const std::function<bool(const Held&)>& is_meant) {
  std::vector<Held> dropped;
  for (auto held = mail_.begin(); held != mail_.end();) {
    if (is_meant(held->second)) {
      waiting_.erase(held->second.ticket);
      dropped.push_back(std::move(held->second));
      held = mail_.erase(held);
    } else {
      ++held;
    }
  }
  return dropped;
}

bool HeldMail::hasForOthers(MemberId id) const {
  return std::any_of(mail_.begin(), mail_.end(),
                     [id](const auto& entry) { return entry.second.receiver != id; });
}

Carried Carriage::carry(Passage passage) const {
  Carried carried{now_()};
  for (const auto& carrier : carriers_) {
    passage.from = carried.due;
    carried = carrier->carry(passage);
    carried.due = std::max(carried.due, passage.from);
    if (!carried.lost.empty() || carried.ticket != 0) {
      break;
    }
  }
  return carried;
}

std::vector<Held> Carriage::arrive() {
  std::vector<Held> taken = held.take(addSaturated(now_(), lookahead_));
  for (const Held& one : taken) {
    arrived_.push_back(one.bytes);
  }
  return taken;
}

}  // namespace move_base_abstract
