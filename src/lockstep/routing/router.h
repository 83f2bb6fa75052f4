// Routes messages and calls between participants, by the names of topics and services. No ROS, no
// sockets, no time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "carrier.h"
#include "goals.h"
#include "held_mail.h"
#include "late_links.h"
#include "lockstep/rounds/rounds.h"
#include "lockstep/wire/wire.h"
#include "stored_topics.h"

namespace move_base_abstract {

/**
 * @brief Turns the actions of a report into mail for other participants.
 *
 * Actions are applied one after the other, in an order that the caller decides. A change by one
 * action holds for the next one. Names are looked up when they are declared; after that, numbers
 * stand for them. In a round, the links of a participant open before, and close after, everything
 * that it sent. A link that closes and opens again in one round is announced as open once more (a
 * repeated PUBLISHER or SUBSCRIBER), never as closed.
 */
class MessageRouter {
 public:
  /**
   * @brief An action was wrong, so its participant is to be dropped. The text says what was wrong.
   */
  class BadAction : public std::runtime_error {
   public:
    using std::runtime_error::runtime_error;
  };

  /** @brief A message, call or response that found its receivers, for a log. */
  struct Delivery {
    using Kind = Passage::Kind;
    Kind kind;
    MailOrder order;
    std::string_view name;  // of the topic or service
    MemberId sender;        // 0: the time master itself (for a call without a server or an answer)
    std::vector<MemberId> receivers;  // empty for a call without a server
    wire::CallStatus status;          // of a response
    std::string_view bytes;
    std::string_view type = {};         // of a message
    std::string_view lost = {};         // why it is lost; '' if it arrives
    std::string_view sender_name = {};  // if the sender may have gone; else ''

    using NameOf = std::function<std::string(MemberId)>;
    const char* kindName() const;  // as in the event log
    std::string from(const NameOf& name_of) const;
    std::vector<std::string> to(const NameOf& name_of) const;  // in natural order
  };

  using Post = std::function<void(MemberId receiver, Mail mail)>;
  using Place = std::function<MailOrder(MemberId sender, std::uint32_t sub, std::uint64_t number)>;
  using Trace = std::function<void(const Delivery&)>;

  /**
   * @param post takes mail for a member.
   * @param place gives the place of an action in its round.
   * @param trace if given, is called for everything that was delivered.
   */
  MessageRouter(Post post, Place place, Trace trace = {});

  /** @brief Call @p trace for everything that is delivered from now on. */
  void setTrace(Trace trace) { trace_ = std::move(trace); }

  /**
   * @brief Set the topics whose messages are kept for the receiver's next grant. Call this first.
   */
  void setStored(StoredTopics topics) { stored_ = std::move(topics); }

  /**
   * @brief Send messages, calls and responses by way of @p carriage, which must outlive this
   * object.
   */
  void setCarriage(Carriage& carriage) { carriage_ = &carriage; }
  /**
   * @brief Take the outcome of the mail that waited with this ticket: it arrives now or later, or
   * is lost.
   */
  void decide(std::uint64_t ticket, const Carried& carried);
  /** @brief Let links be up later than they are made. Call setCarriage(), too. */
  void setLateLinks(LateLinks::Due due) { late_links_.setDue(std::move(due)); }
  /** @return the instant at which to call arrive() for a link, or kNever. */
  Nanoseconds nextLink() const { return late_links_.nextDue(); }
  /** @brief Post the mail under way that arrives now, and the news of links that are up now. */
  void arrive();
  /** @brief Lose the mail under way, since the run ends. */
  void loseCarried();

  void add(MemberId id, const std::string& name);

  /**
   * @brief Apply one action of @p sender, its @p number th. LOG, NOTE and other items that are not
   * for the router are ignored.
   * @throws BadAction if the action refers to something that was not declared.
   */
  void apply(MemberId sender, std::uint64_t number, const wire::ReportItem& item);

  /** @brief End the links and calls of a participant that left or died. */
  void remove(MemberId id, std::uint64_t number);

  /** @brief Post the news of links that closed in this round and stayed closed. */
  void finishRound();

  /** @return the warnings for the user since the last call, such as types that do not match. */
  std::vector<std::string> takeWarnings();

  std::uint64_t messages() const { return messages_; }  // delivered, one for each receiver
  /** @return the name of a topic, by a participant's own number for it; '' if there is none. */
  std::string_view topicName(MemberId id, std::uint32_t number) const;
  /** @return the md5 with which @p sender advertises the topic; '' if it does not. */
  std::string_view md5Of(std::string_view topic, MemberId sender) const;
  std::size_t topics() const { return topics_.size(); }
  std::size_t openCalls() const { return calls_.size(); }
  /** @return the number of waits for services that no participant serves yet. */
  std::size_t watches() const;
  const OpenGoals& goals() const { return goals_; }
  /** @brief What participants want and none of them provides. */
  struct Wanted {
    bool is_any = false;                // a topic that they hear, or a service
    std::vector<std::string> services;  // that they wait for
  };
  Wanted wanted() const;

 private:
  using Index = std::uint32_t;
  struct Advertised {
    MemberId member;
    std::uint32_t topic;  // the member's own number
    std::string_view type;
    std::string_view md5;
    bool latched;
    std::string_view definition;
  };
  struct Subscribed {
    MemberId member;
    std::uint32_t topic;  // the member's own number
    std::string_view md5;
    std::uint32_t sub;       // index of its robot within a fleet
    bool is_stored = false;  // see setStored()
    wire::Delivery delivery = wire::Delivery::kAll;
  };
  struct Topic {
    std::string_view name;
    std::vector<Advertised> publishers;
    std::vector<Subscribed> subscribers;
    OpenGoals::Part part = OpenGoals::Part::kNone;  // its part in an action
  };
  static std::string_view typeOf(const Topic& topic, MemberId sender);
  struct LocalTopic {
    Index topic;
    bool advertised = false;
    std::string_view md5;  // as it advertised it
  };
  struct Server {
    MemberId member;
    std::uint32_t service;  // the member's own number
    std::uint32_t sub;
  };
  struct Service {
    std::string_view name;
    std::vector<Server> servers;  // the last one serves, as with the ROS master
    std::vector<MemberId> watchers;
  };
  struct OpenCall {
    Index service;
    Server server;
    std::uint32_t sub;  // the caller's robot
  };
  struct Participant {
    std::string name;
    std::unordered_map<std::uint32_t, LocalTopic> topics;  // by own number
    std::unordered_map<std::uint32_t, Index> services;     // by own number; those it offers
    std::set<Index> watched;
    std::uint64_t last_call = 0;  // number of its latest call + 1
  };
  struct Action {
    MemberId sender;
    std::uint64_t number;
  };
  struct Closing {
    bool publisher;  // `other` has gone as a publisher; else as a subscriber
    MemberId receiver;
    std::uint32_t number;  // the receiver's own number for the topic
    Index topic;
    MemberId other;
    MailOrder order;
  };

  void act(const Action& by, const wire::Advertise& item);
  void act(const Action& by, const wire::Unadvertise& item);
  void act(const Action& by, const wire::Subscribe& item);
  void act(const Action& by, const wire::Unsubscribe& item);
  void act(const Action& by, const wire::Send& item);
  void act(const Action& by, const wire::Serve& item);
  void act(const Action& by, const wire::Unserve& item);
  void act(const Action& by, const wire::Call& item);
  void act(const Action& by, const wire::Response& item);
  void act(const Action& by, const wire::Watch& item);
  void act(const Action& by, const wire::ChooseDelivery& item);
  void act(const Action&, const wire::Log&) {}
  void act(const Action&, const wire::Note&) {}
  void act(const Action&, const wire::At&) {}  // it was taken out of the report before, as
  void act(const Action&, const wire::Play&) {}
  void act(const Action&, const wire::Rest&) {}
  void act(const Action&, const wire::Background&) {}
  void act(const Action&, const wire::Parameter&) {}
  void act(const Action&, const wire::Asks&) {}
  void act(const Action&, const wire::Idle&) {}
  void act(const Action&, const wire::KeepUntil&) {}
  void act(const Action&, const wire::Motion&) {}

  std::string_view keep(std::string_view text);
  LocalTopic& declare(MemberId id, std::uint32_t number, std::string_view name);
  LocalTopic& declared(MemberId id, std::uint32_t number, const char* what);
  void checkNumber(MemberId id, const Topic& topic, std::uint32_t known, std::uint32_t got) const;
  Index serviceOf(std::string_view name);
  Participant& participant(MemberId id) { return participants_.at(id); }
  void link(const Action& by, const Topic& topic, const Advertised& publisher,
            const Subscribed& subscriber);
  bool isLate(const Action& by, const Topic& topic, const Link& link);
  void open(const Action& by, const Advertised& publisher, const Subscribed& subscriber);
  Link linkOf(const Topic& topic, MemberId publisher, MemberId subscriber) const {
    return {static_cast<Index>(&topic - topics_.data()), publisher, subscriber};
  }
  void tellHearing(const Action& by, const Advertised& publisher, const Subscribed& subscriber);
  void noteGoal(MemberId sender, const Topic& topic, std::string_view payload, bool is_received,
                const std::vector<MemberId>& later);
  bool linked(const Topic& topic, MemberId publisher, MemberId subscriber) const;
  std::string_view definitionOf(const wire::Advertise& item);
  bool awaitsResults(MemberId client, std::string_view goal_topic) const;
  void stopAdvertising(const Action& by, LocalTopic& local);
  void stopSubscribing(const Action& by, LocalTopic& local);
  void stopServing(const Action& by, Index service);
  void answer(MemberId caller, std::uint32_t number, wire::CallStatus status,
              std::string_view bytes, MemberId server, std::string_view service,
              const MailOrder& order);
  // For carried mail (router_carried.cpp).
  bool arrivesAtOnce(const Action& by, const wire::Send& item, const Topic& topic,
                     const wire::Deliver& deliver, MemberId receiver);
  bool arrivesAtOnce(const Action& by, const wire::Call& item, const Service& service,
                     const Server& server);
  bool arrivesAtOnce(const Action& by, const wire::Response& item, const OpenCall& call);
  Passage passage(Passage::Kind kind, const Action& by, std::uint32_t sub, MemberId receiver,
                  std::uint32_t receiver_sub, std::string_view name, std::string_view bytes) const;
  bool carry(const Passage& passage, std::uint64_t number, const wire::GrantItem& item,
             std::string_view bytes, std::uint32_t call = 0);
  void fail(const Held& held, std::uint32_t call, Nanoseconds due);
  void arriveOne(const Held& held);
  void traceHeld(const Held& held, std::string_view lost);
  void dropMessages(const Topic& topic, MemberId sender, MemberId receiver);
  void dropCalls(std::string_view service, MemberId server);
  void dropCallsOf(MemberId caller);
  void drop(const std::function<bool(const Held&)>& is_meant, std::string_view why);
  [[noreturn]] void bad(MemberId id, const std::string& text) const;

  Post post_;
  Place place_;
  Trace trace_;
  StoredTopics stored_;
  bool is_lost_ = false;          // whether the latest passage was lost
  Carriage* carriage_ = nullptr;  // null: everything arrives at once
  LateLinks late_links_;
  std::set<std::string, std::less<>> texts_;  // names, types and definitions; never freed
  std::unordered_map<std::string_view, std::string_view> definitions_;  // by md5
  std::map<MemberId, Participant> participants_;
  std::unordered_map<std::string_view, Index> topic_numbers_;
  std::vector<Topic> topics_;
  std::unordered_map<std::string_view, Index> service_numbers_;
  std::vector<Service> services_;
  std::map<std::pair<MemberId, std::uint32_t>, OpenCall> calls_;  // by caller and its number
  std::vector<Closing> closings_;
  // publisher, its topic, and who has begun to hear it in this round: it gets what is latched once
  std::set<std::tuple<MemberId, std::uint32_t, MemberId>> greeted_;
  OpenGoals goals_;
  std::vector<std::string> warnings_;
  std::uint64_t messages_ = 0;
};

}  // namespace move_base_abstract
