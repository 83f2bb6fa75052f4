// Who gets what: topics, latched links, services and departures, without time and rounds.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "message_routing.h"

namespace move_base_abstract::message_router_test {
namespace {

using Items = std::vector<std::string>;

TEST_F(Routing, BothEndsHearOfALinkWhoeverComesFirst) {
  act(1, advertise(5, "/x"));
  act(2, subscribe(6, "/x"));
  EXPECT_EQ(got(1), Items{"subscriber 5 2"});
  act(3, subscribe(7, "/x"));
  EXPECT_EQ(got(3), Items{"publisher 7 1"});
  act(2, advertise(6, "/x"));
  EXPECT_EQ(got(2), (Items{"publisher 6 2", "subscriber 6 2", "subscriber 6 3"}));
}

TEST_F(Routing, TheDeafAreLinkedAndGetNothingAndWhoPublishesIsTold) {
  act(1, advertise(5, "/x"));
  act(2, subscribe(6, "/x"));
  act(3, subscribe(7, "/x"));
  got(1);
  act(2, wire::ChooseDelivery{6, wire::Delivery::kAll});  // as before
  act(2, wire::ChooseDelivery{6, wire::Delivery::kNothing});
  act(2, wire::ChooseDelivery{6, wire::Delivery::kNothing});
  EXPECT_EQ(got(1), Items{"heard 0 5 2"});
  act(1, wire::Send{5, 0, 0, "to all"});
  act(1, wire::Send{5, 0, 2, "to one"});
  EXPECT_EQ(got(3), Items{"deliver 7 1 to all"});
  act(1, wire::Send{5, 0, 0, "to all"});
  EXPECT_EQ(got(2), Items{});
  act(2, wire::ChooseDelivery{6, wire::Delivery::kAll});
  act(1, wire::Send{5, 0, 0, "more"});
  EXPECT_EQ(got(2), Items{"deliver 6 1 more"});
  act(2, wire::ChooseDelivery{6, wire::Delivery::kNothing});
  got(1);
  act(2, wire::ChooseDelivery{6, wire::Delivery::kAll});
  EXPECT_EQ(got(1), Items{"heard 2 5 2"});
}

TEST_F(Routing, WhoOnlyPutsMessagesByGetsThemLaterAndNobodyIsToldOfThat) {
  act(1, advertise(5, "/x"));
  act(2, subscribe(6, "/x"));
  act(3, subscribe(7, "/x"));
  act(2, wire::ChooseDelivery{6, wire::Delivery::kLater});
  got(1);
  act(2, wire::ChooseDelivery{6, wire::Delivery::kLater});
  act(1, wire::Send{5, 0, 0, "by"});
  EXPECT_EQ(later_, (std::vector<bool>{true, false}));
  act(2, wire::ChooseDelivery{6, wire::Delivery::kAll});
  act(1, wire::Send{5, 0, 2, "one"});
  EXPECT_EQ(later_, (std::vector<bool>{true, false, false}));
  EXPECT_EQ(got(1), Items{});
}

TEST_F(Routing, WhoPublishesLaterIsToldOfTheDeaf) {
  act(2, subscribe(6, "/x"));
  act(2, wire::ChooseDelivery{6, wire::Delivery::kNothing});
  act(1, advertise(5, "/x"));
  EXPECT_EQ(got(1), (Items{"subscriber 5 2", "heard 0 5 2"}));
  act(2, wire::Unsubscribe{6});
  act(2, subscribe(6, "/x"));
  act(1, wire::Send{5, 0, 0, "anew"});
  EXPECT_EQ(got(2), (Items{"publisher 6 1", "deliver 6 1 anew"}));
}

TEST_F(Routing, HearsIsForTopicsThatAreSubscribedTo) {
  act(1, advertise(5, "/x"));
  EXPECT_EQ(refusal(1, wire::ChooseDelivery{5, wire::Delivery::kNothing}),
            "'/node_1': CHOOSE_DELIVERY must name a topic that it subscribes to, got '/x'");
  EXPECT_NE(refusal(1, wire::ChooseDelivery{6, wire::Delivery::kNothing})
                .find("CHOOSE_DELIVERY must name a topic that was declared, got number 6"),
            std::string::npos);
}

TEST_F(Routing, ADefinitionThatIsLeftOutIsTheOneThatWasGivenForItsSum) {
  act(3, wire::Subscribe{7, 0, "/first", "md5"});
  act(3, wire::Subscribe{8, 0, "/second", "md5"});
  act(1, wire::Advertise{5, 0, "/first", "type", "md5", false, "string data"});
  act(2, wire::Advertise{6, 0, "/second", "type", "md5", false, ""});
  EXPECT_EQ(got(3), (Items{"publisher 7 1", "publisher 8 2"}));
  act(3, wire::Unsubscribe{8});
  got(3);
  act(3, wire::Subscribe{8, 0, "/second", "md5"});
  EXPECT_EQ(got(3), Items{"publisher 8 2"});
  EXPECT_EQ(definitions_, (Items{"string data", "string data", "string data"}));
}

TEST_F(Routing, AMessageGoesToAllThatSubscribeAtThatMomentAlsoItsSender) {
  act(1, advertise(5, "/x"));
  act(1, subscribe(5, "/x"));
  act(2, subscribe(6, "/x"));
  got(1);
  act(1, wire::Send{5, 0, 0, "one"});
  act(3, subscribe(7, "/x"));
  act(2, wire::Unsubscribe{6});
  act(1, wire::Send{5, 0, 0, "two"});
  EXPECT_EQ(got(1),
            (Items{"deliver 5 1 one", "subscriber 5 3", "deliver 5 1 two", "no subscriber 5 2"}));
  act(1, wire::Send{5, 0, 0, "three"});
  EXPECT_EQ(got(3), Items{"deliver 7 1 three"});
  EXPECT_EQ(router_.messages(), 6U);
  EXPECT_EQ(traced_, (Items{"/x 1 -> 1 2", "/x 1 -> 1 3", "/x 1 -> 1 3"}));
}

TEST_F(Routing, ALatchedMessageGoesToItsTargetOnly) {
  act(1, advertise(5, "/x", "md5", true));
  act(2, subscribe(6, "/x"));
  act(3, subscribe(7, "/x"));
  got(1);
  act(1, wire::Send{5, 0, 3, "latched"});
  act(1, wire::Send{5, 0, 99, "to nobody"});
  EXPECT_EQ(got(2), Items{});
  act(1, wire::Send{5, 0, 3, "latched"});
  EXPECT_EQ(got(3), Items{"deliver 7 1 latched"});
}

TEST_F(Routing, TypesThatDifferAreNotConnectedAndNamed) {
  act(1, advertise(5, "/x", "one"));
  act(2, subscribe(6, "/x", "other"));
  act(3, subscribe(7, "/x", "*"));
  act(1, wire::Send{5, 0, 0, "data"});
  EXPECT_EQ(got(2), Items{});
  const auto warnings = router_.takeWarnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(
      warnings[0],
      "topic '/x' is not connected from '/node_1' (type test/Type, md5 one) to '/node_2' (md5 "
      "other): their types differ");
  act(1, wire::Send{5, 0, 0, "data"});
  EXPECT_EQ(got(3), Items{"deliver 7 1 data"});
  act(2, subscribe(6, "/x", "one"));  // now with the right type
  EXPECT_EQ(got(2), Items{"publisher 6 1"});
}

TEST_F(Routing, ALinkThatClosesAndOpensInOneRoundIsNotSaidToBeClosed) {
  act(1, advertise(5, "/x"));
  act(2, subscribe(6, "/x"));
  got(1);
  act(1, wire::Unadvertise{5});
  act(1, advertise(5, "/x"));
  EXPECT_EQ(got(2), Items{"publisher 6 1"});
  act(1, wire::Unadvertise{5});
  EXPECT_EQ(got(2), Items{"no publisher 6 1"});
  EXPECT_EQ(got(2), Items{});
}

TEST_F(Routing, WhoSubscribesAgainAndAgainInOneRoundIsGreetedOnce) {
  act(1, advertise(5, "/x"));
  for (int i = 0; i < 2; ++i) {
    act(2, subscribe(6, "/x"));
    act(2, wire::Unsubscribe{6});
  }
  act(2, subscribe(6, "/x"));
  EXPECT_EQ(got(1), Items{"subscriber 5 2"});
  act(2, wire::Unsubscribe{6});
  act(2, subscribe(6, "/x"));
  EXPECT_EQ(got(1), Items{"subscriber 5 2"});
}

TEST_F(Routing, RepeatedDeclarationsOfOneNodeChangeNothing) {
  act(1, advertise(5, "/x"));
  act(2, subscribe(6, "/x"));
  got(1);
  act(1, advertise(5, "/x"));
  act(2, subscribe(6, "/x"));
  EXPECT_EQ(got(2), Items{});
  act(1, wire::Send{5, 0, 0, "once"});
  EXPECT_EQ(got(2), Items{"deliver 6 1 once"});
}

TEST_F(Routing, WhatWasNotDeclaredIsRefused) {
  EXPECT_EQ(refusal(1, wire::Send{5, 0, 0, ""}),
            "'/node_1': SEND must name a topic that was declared, got number 5");
  act(1, subscribe(5, "/x"));
  EXPECT_EQ(refusal(1, wire::Send{5, 0, 0, ""}),
            "'/node_1': SEND must be on a topic that it advertises, got '/x'");
  EXPECT_EQ(refusal(1, advertise(5, "/y")),
            "'/node_1': number 5 is that of topic '/x', got it for '/y'");
  EXPECT_EQ(refusal(1, subscribe(6, "/x")),
            "'/node_1': topic '/x' has its number 5, got a second one, 6");
  EXPECT_EQ(refusal(1, subscribe(8, "")), "'/node_1': topic 8 must have a name, got an empty one");
  EXPECT_EQ(refusal(1, wire::Unserve{3}),
            "'/node_1': UNSERVE must name a service that it serves, got number 3");
  EXPECT_EQ(refusal(2, wire::Response{1, 4, true, ""}),
            "'/node_2': RESPONSE must answer a call, got number 4 of '/node_1', which has not made "
            "it");
}

TEST_F(Routing, ACallGoesToItsServerAndTheAnswerBack) {
  act(2, wire::Serve{9, 0, "/s"});
  act(1, wire::Call{0, 0, "/s", "request"});
  act(1, wire::Call{1, 0, "/nobody", "request"});
  EXPECT_EQ(got(1), Items{"answer 1 2"});
  act(2, wire::Response{1, 0, true, "response"});
  act(2, wire::Response{1, 0, true, "twice"});  // is ignored
  EXPECT_EQ(got(1), Items{"answer 0 1"});
  act(1, wire::Call{2, 0, "/s", "request"});
  EXPECT_EQ(got(2), Items{"call 9 1 2"});
  EXPECT_EQ(refusal(1, wire::Call{2, 0, "/s", ""}),
            "'/node_1': CALL must count up, got number 2 after 2");
  EXPECT_EQ(traced_, (Items{"/s 1 -> 2", "/nobody 0 -> 1", "/s 2 -> 1", "/s 1 -> 2"}));
}

TEST_F(Routing, TheLastServerOfANameServesAsWithTheRosMaster) {
  act(2, wire::Serve{9, 0, "/s"});
  act(3, wire::Serve{4, 0, "/s"});
  EXPECT_EQ(router_.takeWarnings(), Items{"service '/s' of '/node_2' is taken over by '/node_3'"});
  act(1, wire::Call{0, 0, "/s", ""});
  EXPECT_EQ(got(3), Items{"call 4 1 0"});
  act(3, wire::Unserve{4});
  EXPECT_EQ(got(1), Items{"answer 0 3"});
  act(1, wire::Call{1, 0, "/s", ""});
  EXPECT_EQ(got(2), Items{"call 9 1 1"});
}

TEST_F(Routing, AWatcherHearsOnceOfAService) {
  act(1, wire::Watch{"/s"});
  act(1, wire::Watch{"/s"});
  EXPECT_EQ(got(1), Items{});
  act(2, wire::Serve{9, 0, "/s"});
  EXPECT_EQ(got(1), Items{"found /s"});
  act(3, wire::Serve{9, 0, "/s"});
  EXPECT_EQ(got(1), Items{});
  act(1, wire::Watch{"/s"});
  EXPECT_EQ(got(1), Items{"found /s"});
}

TEST_F(Routing, AReAdvertiseThatLatchesAnewIsALinkAnew) {
  act(1, advertise(5, "/x", "md5", false));
  act(2, subscribe(6, "/x"));
  EXPECT_EQ(got(2), Items{"publisher 6 1"});
  act(1, advertise(5, "/x", "md5", true));
  EXPECT_EQ(got(2), Items{"publisher 6 1"});
  act(1, advertise(5, "/x", "md5", true));
  EXPECT_EQ(got(2), Items{});
  act(1, advertise(5, "/x", "md5", false));
  EXPECT_EQ(got(1), Items{"subscriber 5 2"});
  EXPECT_EQ(latched_, (std::vector<bool>{false, true, false}));
}

TEST_F(Routing, AnAnswerCountsFromTheServerThatWasAskedOnly) {
  act(2, wire::Serve{9, 0, "/s"});
  act(1, wire::Call{0, 0, "/s", "request"});
  act(3, wire::Response{1, 0, true, "of a stranger"});
  act(1, wire::Response{1, 0, true, "of the caller"});
  EXPECT_EQ(got(1), Items{});
  EXPECT_EQ(router_.openCalls(), 1U);
  act(3, wire::Serve{4, 0, "/s"});  // who serves now was not asked
  act(3, wire::Response{1, 0, true, "of the next server"});
  EXPECT_EQ(got(1), Items{});
  act(2, wire::Response{1, 0, true, "response"});
  EXPECT_EQ(got(1), Items{"answer 0 1"});
}

TEST_F(Routing, WatchesAndCallsEndWithThoseThatWaitForThem) {
  act(1, wire::Watch{"/s"});
  act(2, wire::Watch{"/s"});
  act(2, wire::Watch{"/t"});
  EXPECT_EQ(router_.watches(), 3U);
  router_.remove(2, 99);
  EXPECT_EQ(router_.watches(), 1U);
  act(3, wire::Serve{9, 0, "/s"});
  EXPECT_EQ(got(1), Items{"found /s"});
  EXPECT_EQ(router_.watches(), 0U);
  act(1, wire::Call{0, 0, "/s", ""});
  act(1, wire::Call{1, 0, "/s", ""});
  act(3, wire::Response{1, 1, true, ""});
  EXPECT_EQ(router_.openCalls(), 1U);
  act(3, wire::Unserve{9});
  EXPECT_EQ(router_.openCalls(), 0U);
  act(1, wire::Watch{"/s"});  // once more, after it was found and lost
  act(3, wire::Serve{9, 0, "/s"});
  EXPECT_EQ(got(1), (Items{"answer 1 1", "answer 0 3", "found /s"}));
  act(1, wire::Call{2, 0, "/s", ""});
  router_.remove(1, 99);
  EXPECT_EQ(router_.openCalls(), 0U);
}

TEST_F(Routing, ADepartureEndsLinksAndCallsOfBothDirections) {
  act(1, advertise(5, "/x"));
  act(2, subscribe(6, "/x"));
  act(2, advertise(8, "/y"));
  act(1, subscribe(7, "/y"));
  act(1, wire::Serve{9, 0, "/s"});
  act(2, wire::Call{0, 0, "/s", ""});
  act(3, wire::Serve{4, 0, "/t"});
  act(1, wire::Call{0, 0, "/t", ""});
  got(1);
  router_.remove(1, 99);
  EXPECT_EQ(got(2), (Items{"answer 0 3", "no publisher 6 1", "no subscriber 8 1"}));
  act(3, wire::Response{1, 0, true, "too late"});
  act(2, wire::Send{8, 0, 0, "to nobody"});
  EXPECT_EQ(got(1), Items{});
}

}  // namespace
}  // namespace move_base_abstract::message_router_test
