// Items of a grant as texts.
#pragma once

#include <cstdint>
#include <string>

#include "lockstep/wire/wire.h"
#include "lockstep_script.h"

namespace move_base_abstract {

/** @return the item as text if it says an instant [ns]; else ''. */
inline std::string instantText(const wire::GrantItem& item) {
  if (const auto* a = std::get_if<wire::Came>(&item)) {
    return "came " + std::to_string(a->time_ns);
  }
  if (const auto* a = std::get_if<wire::Arrives>(&item)) {
    return "at " + std::to_string(a->time_ns);
  }
  const auto* a = std::get_if<wire::Window>(&item);
  return a == nullptr ? "" : "to " + std::to_string(a->end_ns);
}

struct SameId {
  std::uint32_t operator()(std::uint32_t id) const { return id; }
};

/** @brief An item of a grant as text; `who` turns ids into places in the list of participants. */
template <typename Who = SameId>
std::string itemText(const wire::GrantItem& item, const Who& who = {}) {
  const auto s = [](std::uint64_t number) { return std::to_string(number); };
  if (const auto* a = std::get_if<wire::Publisher>(&item)) {
    return "publisher " + s(topicOf(a->topic)) + " " + s(who(a->sender));
  }
  if (const auto* a = std::get_if<wire::NoPublisher>(&item)) {
    return "no publisher " + s(topicOf(a->topic)) + " " + s(who(a->sender));
  }
  if (const auto* a = std::get_if<wire::Subscriber>(&item)) {
    return "subscriber " + s(topicOf(a->topic)) + " " + s(who(a->receiver));
  }
  if (const auto* a = std::get_if<wire::NoSubscriber>(&item)) {
    return "no subscriber " + s(topicOf(a->topic)) + " " + s(who(a->receiver));
  }
  if (const auto* a = std::get_if<wire::Deliver>(&item)) {
    return "deliver " + s(topicOf(a->topic)) + " " + s(who(a->sender)) + " " +
           std::string(a->payload);
  }
  if (const auto* a = std::get_if<wire::CallIn>(&item)) {
    return "call " + s(topicOf(a->service)) + " " + s(who(a->caller)) + " " + s(a->number);
  }
  if (const auto* a = std::get_if<wire::Answer>(&item)) {
    return "answer " + s(a->number) + " " + s(static_cast<std::uint64_t>(a->status));
  }
  if (const auto* a = std::get_if<wire::Happened>(&item)) {
    return "happened " + std::to_string(a->until_ns / 1'000'000);
  }
  if (const auto* a = std::get_if<wire::DeliveryChosen>(&item)) {
    return "heard " + s(static_cast<std::uint64_t>(a->what)) + " " + s(topicOf(a->topic)) + " " +
           s(who(a->receiver));
  }
  if (std::holds_alternative<wire::Changed>(item)) {
    return "changed";
  }
  if (const std::string instant = instantText(item); !instant.empty()) {
    return instant;
  }
  return "found " + std::string(std::get<wire::Found>(item).service);
}

}  // namespace move_base_abstract
