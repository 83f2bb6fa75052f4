// A router without time and rounds, and what participants got.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "lockstep/routing/router.h"
#include "lockstep_client.h"
#include "lockstep_items.h"
#include "lockstep_model.h"

namespace move_base_abstract {

class Routing : public testing::Test {
 protected:
  Routing()
      : router_([this](MemberId id, const Mail& mail) { take(id, mail); },
                [](MemberId id, std::uint32_t sub, std::uint64_t number) {
                  return MailOrder{0, sub, id, number};
                },
                [this](const MessageRouter::Delivery& delivery) {
                  traced_.push_back(text(delivery));
                }) {
    for (const MemberId id : {1U, 2U, 3U}) {
      router_.add(id, "/node_" + std::to_string(id));
    }
  }

  void act(MemberId id, const wire::ReportItem& item) { router_.apply(id, number_++, item); }

  std::string refusal(MemberId id, const wire::ReportItem& item) {
    try {
      act(id, item);
    } catch (const MessageRouter::BadAction& error) {
      return error.what();
    }
    return "was done";
  }

  /** @return what @p id got since the last call, and forget what others got. */
  std::vector<std::string> got(MemberId id) {
    router_.finishRound();
    const std::vector<std::string> items = mail_[id];
    mail_.clear();
    return items;
  }

  static std::string text(const MessageRouter::Delivery& delivery) {
    std::string text = std::string(delivery.name) + " " + std::to_string(delivery.sender) + " ->";
    for (const MemberId id : delivery.receivers) {
      text += " " + std::to_string(id);
    }
    return text;
  }

  MessageRouter router_;
  std::vector<std::string> traced_;
  std::vector<std::string> definitions_;  // in the PUBLISHER items so far
  std::vector<bool> latched_;             // the same
  std::vector<bool> later_;               // of the DELIVER items so far

 private:
  void take(MemberId id, const Mail& mail) {
    if (const auto* publisher = std::get_if<wire::Publisher>(&mail.item)) {
      definitions_.emplace_back(publisher->definition);
      latched_.push_back(publisher->latched);
    }
    if (std::holds_alternative<wire::Deliver>(mail.item)) {
      later_.push_back(mail.keep == Keep::kLater);
    }
    mail_[id].push_back(itemText(mail.item));
  }

  std::map<MemberId, std::vector<std::string>> mail_;
  std::uint64_t number_ = 0;
};

}  // namespace move_base_abstract
