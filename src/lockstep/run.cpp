#include "run.h"

#include <stdexcept>
#include <utility>

#include "clock/number_text.h"

namespace move_base_abstract {

LockstepRun::LockstepRun(const LockstepSettings& given, Nanoseconds wall_now)
    : settings(given),
      rounds(given),
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
}

void LockstepRun::addCarrier(std::unique_ptr<Carrier> carrier) {
  if (rounds.hasWindows()) {
    throw std::invalid_argument(
        "delays of single messages must be without a lookahead, which delays all alike: got one of " +
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
