#include "run.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "clock/number_text.h"

namespace move_base_abstract {

namespace {

/** @brief Hand unread mail over at once with chaos. Otherwise its order would be the stated one. */
LockstepSettings settingsOf(LockstepSettings settings) {
  settings.keep_unread = settings.keep_unread && settings.chaos_seed == 0;
  return settings;
}

/** @return @p what and the bound @p seconds in words; '' if that is 0. */
std::string upTo(const char* what, double seconds) {
  return seconds == 0.0 ? "" : what + secondsText(toNanoseconds(seconds));
}

}  // namespace

std::string chaosText(const LockstepSettings& settings) {
  if (settings.chaos_seed == 0) {
    return "";
  }
  return "chaos seed " + std::to_string(settings.chaos_seed) +
         upTo(" with delays up to ", settings.chaos_delay) +
         upTo(settings.chaos_delay == 0.0 ? " with starts up to " : " and starts up to ",
              settings.chaos_starts) +
         (settings.chaos_starts == 0.0 ? "" : " late") +
         (settings.chaos_only.empty() ? "" : ", some decisions only");
}

LockstepRun::LockstepRun(const LockstepSettings& given, Nanoseconds wall_now)
    : settings(settingsOf(given)),
      decisions(given.chaos_seed, chaos::decisionsOf(given.chaos_only), given.keeps_decisions),
      rounds(settings),
      kept(static_cast<std::size_t>(given.keep_messages)),
      log(rounds, given.keeps_bytes, [this](const auto& line) { stops.sees(line); }),
      carriage([this]() { return rounds.now(); }, toNanoseconds(given.lookahead)),
      router([this](MemberId id, Mail mail) { rounds.mail().post(id, mail); },
             [this](MemberId id, std::uint32_t sub, std::uint64_t number) {
               return rounds.members().order(id, sub, number);
             }),
      wall(wall_now),
      text(rounds, members),
      labels(messages) {
  router.setStored(StoredTopics(settings.stored_topics));
  if (settings.log_messages || kept.areKept()) {
    traceDeliveries();
  }
  for (const std::string& why : settings.not_covered) {
    labels.addNotRepeatable(why);
  }
  if (!settings.network.empty()) {
    addRadio();
  }
  if (settings.chaos_seed != 0) {
    beChaotic();
  }
}

void LockstepRun::traceDeliveries() {
  router.setTrace([this](const MessageRouter::Delivery& delivery) {
    const auto name_of = [this](MemberId id) { return text.nameOf(id); };
    if (settings.log_messages) {
      log.add(delivery, name_of);
    }
    if (kept.areKept()) {
      kept.add({rounds.now(), delivery.kindName(), std::string(delivery.name),
                std::string(delivery.type),
                std::string(router.md5Of(delivery.name, delivery.sender)), delivery.from(name_of),
                delivery.to(name_of), std::string(delivery.bytes)});
    }
    stops.sees(delivery, name_of);
  });
}

/** @brief Add the radio. It carries first, and other delays come on top. */
void LockstepRun::addRadio() {
  radio::Network network = radio::networkOf(settings.network);
  if (settings.chaos_delay != 0.0 && network.hasWaiting()) {
    throw std::invalid_argument(
        "chaos_delay must be 0 with a network in which messages wait (lost: retry or queue), got " +
        numberText(settings.chaos_delay) + " s");
  }
  auto carrier = std::make_unique<RadioTraffic>(
      std::move(network), toNanoseconds(settings.lookahead),
      RadioTraffic::Voices{
          [this](const RadioTraffic::Line& line) {
            log.add(line.order, {rounds.now(), line.name, line.kind, line.values, "", ""});
          },
          [this](const std::string& why) { labels.addDegraded(why); },
          [this](const std::string& what) { messages.say(LockstepMessage::Level::kWarn, what); },
          [this](const std::string& what) { messages.say(LockstepMessage::Level::kInfo, what); }});
  radio = carrier.get();
  addCarrier(std::move(carrier));
  log.setBefore([this]() {
    std::vector<LockstepLogEntry> lines;
    if (!rounds.started()) {
      return lines;  // the order of joining depends on the wall clock
    }
    for (RadioTraffic::Change& one : radio->changes(rounds.now())) {
      lines.push_back({one.at, one.name, one.kind, one.values, "", ""});
    }
    return lines;
  });
}

void LockstepRun::beChaotic() {
  order = std::make_unique<chaos::Order>(
      decisions, rounds,
      chaos::Names{[this](MemberId id) { return text.nameOf(id); },
                   [this](MemberId id, std::uint32_t number) {
                     return std::string(router.topicName(id, number));
                   }});
  rounds.mail().setArrange(
      [this](MemberId id, std::vector<Mail>& mail) { order->arrangeMail(id, mail); });
  if (settings.chaos_delay != 0.0) {
    addCarrier(std::make_unique<chaos::Delays>(decisions, toNanoseconds(settings.chaos_delay)));
  }
  if (settings.chaos_starts != 0.0) {
    startLate();
  }
  messages.say(LockstepMessage::Level::kInfo, "the order of equal events is that of " +
                                                  chaosText(settings) + ", not the stated one");
}

/** @brief Let nodes, and links between them, start late. */
void LockstepRun::startLate() {
  starts_ = std::make_unique<chaos::Starts>(decisions, toNanoseconds(settings.chaos_starts));
  rounds.members().setLateness(
      [this](const MemberState& member) { return starts_->ofNode(rounds.now(), member.name); });
  router.setLateLinks(
      [this](std::string_view publisher, std::string_view subscriber, std::string_view topic) {
        const Nanoseconds late = starts_->ofLink(rounds.now(), publisher, subscriber, topic);
        return late == 0 ? 0 : addSaturated(rounds.now(), late);
      });
  followArrivals();
}

void LockstepRun::addCarrier(std::unique_ptr<Carrier> carrier) {
  carriage.add(std::move(carrier));
  followArrivals();
}

/** @brief Let time go on for what arrives by itself. */
void LockstepRun::followArrivals() {
  router.setCarriage(carriage);
  rounds.setArrivals({[this]() {
                        const Nanoseconds due = std::min(carriage.nextArrival(), router.nextLink());
                        return radio == nullptr ? due : std::min(due, radio->nextLook());
                      },
                      [this]() {
                        decideWaiting();
                        router.arrive();
                        log.closeRound();
                        rounds.setOwed(router.goals().count() + router.openCalls());
                      }});
}

void LockstepRun::decideWaiting() {
  if (radio != nullptr) {
    for (const auto& [ticket, carried] : radio->look(rounds.now())) {
      router.decide(ticket, carried);
    }
  }
}

}  // namespace move_base_abstract
