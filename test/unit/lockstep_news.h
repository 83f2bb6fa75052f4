// Two participants that tell each other news and answers.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lockstep_client.h"
#include "lockstep_items.h"

namespace move_base_abstract::lockstep_news {

using Texts = std::vector<std::string>;
using Items = std::vector<wire::ReportItem>;

constexpr std::uint32_t kNews = 1;
constexpr std::uint32_t kAnswers = 2;

inline Texts grants(Stage& stage, ConnectionId id) {
  return grants(stage, id, [](const wire::GrantItem& item) { return itemText(item); });
}

/**
 * @brief /a tells news, to which /b listens; /b gives answers, to which /a listens, and serves /do.
 * All linked.
 */
struct Linked : Pair {
  explicit Linked(std::unique_ptr<Carrier> carrier = nullptr,
                  const LockstepSettings& settings = named({"/a", "/b"}))
      : Pair(settings) {
    if (carrier) {
      session.addCarrier(std::move(carrier));
    }
    report(1, kNever, {advertise(kNews, "/news"), subscribe(kAnswers, "/answers")});
    report(2, kNever,
           {subscribe(kNews, "/news"), advertise(kAnswers, "/answers"), wire::Serve{1, 0, "/do"}});
    grants(*this, 1);
    grants(*this, 2);
  }
};

}  // namespace move_base_abstract::lockstep_news
