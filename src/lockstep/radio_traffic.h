// What participants tell each other, on its way over the radio between their hosts.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_TRAFFIC_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_TRAFFIC_H

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lockstep/radio/link_watch.h"
#include "lockstep/radio/radio.h"
#include "lockstep/routing/carrier.h"
#include "lockstep/wire/wire.h"

namespace move_base_abstract {

/** @brief How a link between two hosts is, and what has gone over it in both directions. */
struct LinkState {
  std::string one, other;
  bool is_up;
  std::uint64_t arrived, lost;
  bool has_places;  // of both hosts, as they are known
  radio::Place from, to;
};

/**
 * @brief A carrier between the hosts of a network: knows which participant, or which robot of one,
 * is on which host.
 *
 * What is on no host, or goes on within one, or is wired, arrives at once.
 */
class RadioTraffic : public Carrier {
 public:
  /** @brief A line for the event log, about what was sent at @p order. */
  struct Line {
    MailOrder order;
    std::string name;    // of the topic or service
    std::string kind;    // radio, or radio_lost
    std::string values;  // a JSON array
  };
  using Tell = std::function<void(Line)>;
  using Say = std::function<void(const std::string&)>;
  struct Voices {
    Tell tell;  // of each message between hosts
    Say label;  // why not all is on the air, or not as it is
    Say warn;   // of what may be meant otherwise
    Say inform;
  };

  /** @param lookahead what each message takes at least [ns, simulated]. */
  RadioTraffic(radio::Network network, Nanoseconds lookahead, Voices voices);

  /** @brief It takes part: the hosts of those who do so before the first action are numbered in the
   * order of their names. */
  void join(MemberId id, const std::string& name);
  /** @throws std::invalid_argument if it is no motion. */
  void move(MemberId id, const wire::Motion& motion, Nanoseconds now);

  Carried carry(const Passage& passage) override;
  /** @return the instant at which what waits is to be looked at; kNever: as long as nobody moves
   * otherwise. */
  Nanoseconds nextLook() const { return radio_.nextLook(); }
  /** @brief Decide on what has waited. @return by ticket, in the order of the decisions. */
  std::vector<std::pair<std::uint64_t, Carried>> look(Nanoseconds now);

  /** @brief A line for the event log, with its instant. */
  struct Change {
    Nanoseconds at;
    std::string name;    // of a host; '' of a link
    std::string kind;    // host, or link
    std::string values;  // a JSON array
  };
  /** @return lines on links that have come up or gone down up to @p now, and on fixed hosts that
   * are new. */
  std::vector<Change> changes(Nanoseconds now);
  /** @return whether anything is another than at the last call. */
  bool takeNews() { return std::exchange(has_news_, false); }
  std::vector<LinkState> links(Nanoseconds now) const;

 private:
  using Ends = std::pair<radio::HostId, radio::HostId>;
  struct Sent {
    MailOrder order;
    Ends ends;
    std::string name, values;  // the beginning of them
  };
  struct Counts {
    std::uint64_t arrived = 0;
    std::uint64_t lost = 0;
  };

  void settle(Nanoseconds now);
  radio::HostId hostOf(MemberId id, std::uint32_t sub) const;
  bool isWired(std::string_view name);
  void sayWhatIsNot() const;
  void labelIfAlone(radio::HostId from, std::string_view sender);
  Carried decided(const Sent& sent, const radio::Radio::Outcome& outcome, Nanoseconds now);

  radio::Radio radio_;
  radio::LinkWatch watch_;
  const Nanoseconds lookahead_;
  const Voices voices_;
  std::optional<Nanoseconds> began_;                     // simulated; nothing: nobody has joined
  bool is_said_ = false;                                 // what is not simulated
  std::vector<std::pair<std::string, MemberId>> fresh_;  // have joined, and are on no host as yet
  std::map<MemberId, radio::HostId> nodes_;
  std::map<std::pair<MemberId, std::uint32_t>, radio::HostId> robots_;  // of participants
  std::map<std::string, bool, std::less<>> wired_;
  std::set<std::string> labelled_;
  std::vector<std::pair<std::string, MemberId>> alone_;  // on no host of their own
  std::map<std::uint64_t, Sent> waiting_;
  std::map<Ends, Counts> counts_;
  std::uint64_t ticket_ = 0;
  radio::HostId told_ = 0;  // hosts up to this
  bool has_news_ = true;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_TRAFFIC_H
