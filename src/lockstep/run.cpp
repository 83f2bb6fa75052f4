#include "run.h"

namespace move_base_abstract {

LockstepRun::LockstepRun(const LockstepSettings& given, Nanoseconds wall_now)
    : settings(given),
      rounds(given),
      log(rounds, given.keeps_bytes),
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

}  // namespace move_base_abstract
