#include "round_log.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string_view>
#include <utility>

#include "clock/json_text.h"

namespace move_base_abstract {
namespace {

/** @return the FNV-1a hash of @p bytes, 64 bits, in hex. */
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

void RoundLog::add(const MailOrder& order, const wire::Log& log) {
  round_.push_back({order,
                    {rounds_.now(), std::string(log.robot), std::string(log.kind),
                     std::string(log.values), "", ""}});
}

void RoundLog::add(const MessageRouter::Delivery& delivery, const NameOf& name_of) {
  std::string values = "[";
  appendJson(values, delivery.from(name_of));
  for (const std::string& receiver : delivery.to(name_of)) {
    values += ",";
    appendJson(values, receiver);
  }
  if (delivery.kind == MessageRouter::Delivery::Kind::kResponse) {
    values += "," + std::to_string(static_cast<int>(delivery.status));
  }
  values += "," + std::to_string(delivery.bytes.size()) + ",\"" + hashText(delivery.bytes) + "\"";
  if (!delivery.lost.empty()) {
    values += ",";
    appendJson(values, std::string(delivery.lost));
  }
  values += "]";
  const bool keeps_bytes = keeps_bytes_ && delivery.lost.empty();
  round_.push_back({delivery.order,
                    {rounds_.now(), std::string(delivery.name), delivery.kindName(),
                     std::move(values), keeps_bytes ? std::string(delivery.type) : "",
                     keeps_bytes ? std::string(delivery.bytes) : ""}});
}

void RoundLog::addBefore() {
  if (before_) {
    for (LockstepLogEntry& line : before_()) {
      append(std::move(line));
    }
  }
}

void RoundLog::append(LockstepLogEntry&& line) {
  seen_(line);
  log_.push_back(std::move(line));
}

void RoundLog::closeRound() {
  addBefore();
  std::stable_sort(round_.begin(), round_.end(), [](const Line& a, const Line& b) {
    if (isBefore(a.order, b.order)) {
      return true;
    }
    // Lines of one action come in the order of their values: a member that dies cancels several
    // calls.
    return !isBefore(b.order, a.order) && a.entry.values < b.entry.values;
  });
  for (Line& line : round_) {
    append(std::move(line.entry));
  }
  round_.clear();
}

std::vector<LockstepLogEntry> RoundLog::take() {
  addBefore();  // time may have gone on without a round
  return std::exchange(log_, {});
}

}  // namespace move_base_abstract
