// Carries what participants send each other over the radio between their hosts.
#pragma once

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

/** @brief The state of a link between two hosts, and the counts of messages in both directions. */
struct LinkState {
  std::string one, other;
  bool is_up;
  std::uint64_t arrived, lost;
  bool has_places;  // whether `from` and `to` are known
  radio::Place from, to;
};

/**
 * @brief A carrier between the hosts of a network. It knows the host of each participant, and of
 * each robot of a participant.
 *
 * A message arrives at once if its sender or receiver is on no host, if both are on one host, or if
 * its topic or service is wired.
 */
class RadioTraffic : public Carrier {
 public:
  /** @brief A line for the event log, about the message that was sent at @p order. */
  struct Line {
    MailOrder order;
    std::string name;    // of the topic or service
    std::string kind;    // radio, or radio_lost
    std::string values;  // a JSON array
  };
  using Tell = std::function<void(Line)>;
  using Say = std::function<void(const std::string&)>;
  struct Voices {
    Tell tell;  // the lines, for each message between hosts
    Say label;  // a label: why the radio is not simulated as described
    Say warn;   // what the user may have meant otherwise
    Say inform;
  };

  /** @param lookahead the least time that each message takes [ns, simulated]. */
  RadioTraffic(radio::Network network, Nanoseconds lookahead, Voices voices);

  /**
   * @brief A participant joins. The hosts of participants that join before the first action are
   * numbered in the order of their names.
   */
  void join(MemberId id, const std::string& name);
  /**
   * @brief A robot of @p id has reported how it moves from @p now on. @throws std::invalid_argument
   * if @p motion is not valid.
   */
  void move(MemberId id, const wire::Motion& motion, Nanoseconds now);

  Carried carry(const Passage& passage) override;
  /**
   * @return the instant at which to look() at the waiting messages; kNever: not before a host moves
   * in another way.
   */
  Nanoseconds nextLook() const { return radio_.nextLook(); }
  /**
   * @brief Decide on waiting messages. @return their tickets and outcomes, in the order of the
   * decisions.
   */
  std::vector<std::pair<std::uint64_t, Carried>> look(Nanoseconds now);

  /** @brief A line for the event log, with its instant. */
  struct Change {
    Nanoseconds at;
    std::string name;    // the host's; '' for a link
    std::string kind;    // host, or link
    std::string values;  // a JSON array
  };
  /**
   * @return lines about links that have come up or gone down up to @p now, and about new fixed
   * hosts.
   */
  std::vector<Change> changes(Nanoseconds now);
  /** @return whether anything has changed since the last call. */
  bool takeNews() { return std::exchange(has_news_, false); }
  std::vector<LinkState> links(Nanoseconds now) const;

 private:
  using Ends = std::pair<radio::HostId, radio::HostId>;
  struct Sent {
    MailOrder order;
    Ends ends;
    std::string name, values;  // the latter without its end
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
  std::optional<Nanoseconds> began_;                     // simulated; nothing: no member has joined
  bool is_said_ = false;                                 // that some things are not simulated
  std::vector<std::pair<std::string, MemberId>> fresh_;  // have joined, and have no host as yet
  std::map<MemberId, radio::HostId> nodes_;
  std::map<std::pair<MemberId, std::uint32_t>, radio::HostId> robots_;  // by member, sub
  std::map<std::string, bool, std::less<>> wired_;
  std::set<std::string> labelled_;
  std::vector<std::pair<std::string, MemberId>> alone_;  // are on no host
  std::map<std::uint64_t, Sent> waiting_;
  std::map<Ends, Counts> counts_;
  std::uint64_t ticket_ = 0;
  radio::HostId told_ = 0;  // hosts up to this one have a line
  bool has_news_ = true;
};

}  // namespace move_base_abstract
