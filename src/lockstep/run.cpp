#include "run.h"

#include <stdexcept>
#include <utility>

#include "clock/number_text.h"

namespace move_base_abstract {

namespace {

/** @brief What roscpp programs look at by themselves comes at once with chaos: else its order would
 * be the stated one. */
LockstepSettings settingsOf(LockstepSettings settings) {
  settings.keep_unread = settings.keep_unread && settings.chaos_seed == 0;
  return settings;
}

}  // namespace

std::string chaosText(const LockstepSettings& settings) {
  if (settings.chaos_seed == 0) {
    return "";
  }
  return "chaos seed " + std::to_string(settings.chaos_seed) +
         (settings.chaos_delay == 0.0
              ? ""
              : " with delays up to " + secondsText(toNanoseconds(settings.chaos_delay))) +
         (settings.chaos_only.empty() ? "" : ", some decisions only");
}

LockstepRun::LockstepRun(const LockstepSettings& given, Nanoseconds wall_now)
    : settings(settingsOf(given)),
      decisions(given.chaos_seed, chaos::decisionsOf(given.chaos_only), given.keeps_decisions),
      rounds(settings),
      log(rounds, given.keeps_bytes),
      carriage([this]() { return rounds.now(); }),
      router([this](MemberId id, Mail mail) { rounds.post(id, mail); },
             [this](MemberId id, std::uint32_t sub, std::uint64_t number) {
               return rounds.order(id, sub, number);
             },
             given.log_messages ? MessageRouter::Trace([this](const auto& delivery) {
               log.add(delivery, [this](MemberId id) { return text.nameOf(id); });
             })
                                : MessageRouter::Trace()),
      wall(wall_now),
      text(rounds, members),
      labels(messages) {
  router.setStored(StoredTopics(settings.stored_topics));
  for (const std::string& why : settings.not_covered) {
    labels.addNotRepeatable(why);
  }
  if (settings.chaos_seed != 0) {
    beChaotic();
  }
}

void LockstepRun::beChaotic() {
  order = std::make_unique<chaos::Order>(
      decisions, rounds,
      chaos::Names{[this](MemberId id) { return text.nameOf(id); },
                   [this](MemberId id, std::uint32_t number) {
                     return std::string(router.topicName(id, number));
                   }});
  rounds.setArrange([this](MemberId id, std::vector<Mail>& mail) { order->arrangeMail(id, mail); });
  if (settings.chaos_delay != 0.0) {
    addCarrier(std::make_unique<chaos::Delays>(decisions, toNanoseconds(settings.chaos_delay)));
  }
  messages.say(LockstepMessage::Level::kInfo, "the order of equal events is that of " +
                                                  chaosText(settings) + ", not the stated one");
}

void LockstepRun::addCarrier(std::unique_ptr<Carrier> carrier) {
  if (rounds.hasWindows()) {
    throw std::invalid_argument(
        "delays of single messages must be without a lookahead, which delays all alike: got one "
        "of " +
        numberText(settings.lookahead) + " s");
  }
  carriage.add(std::move(carrier));
  router.setCarriage(carriage);
  rounds.setArrivals({[this]() { return carriage.held.nextDue(); },
                      [this]() {
                        router.arrive();
                        log.closeRound();
                        rounds.setOwed(router.goals().count() + router.openCalls());
                      }});
}

}  // namespace move_base_abstract
