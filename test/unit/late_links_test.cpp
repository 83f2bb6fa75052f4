// Links that are made, and are up later: who hears of them when, and what goes over them.
#include <string>
#include <vector>

#include "message_routing.h"

namespace move_base_abstract::late_links_test {
namespace {

using Items = std::vector<std::string>;

/** @brief Links are up at the instant `due_`, or at once if it is 0. */
class LateRouting : public Routing {
 protected:
  LateRouting() : carriage_([this]() { return now_; }) {
    router_.setCarriage(carriage_);
    router_.setLateLinks([this](auto, auto, auto) { return due_; });
  }

  void goTo(Nanoseconds now) {
    now_ = now;
    router_.arrive();
  }

  Nanoseconds now_ = 1;
  Nanoseconds due_ = 10;
  Carriage carriage_;
};

TEST_F(LateRouting, BothEndsHearOfALateLinkWhenItIsUpAndMessagesNeedIt) {
  act(1, advertise(5, "/x"));
  act(2, subscribe(6, "/x"));
  act(1, wire::Send{5, 0, 0, "lost"});
  EXPECT_EQ(got(2), Items{});
  EXPECT_EQ(router_.nextLink(), 10);
  act(2, wire::ChooseDelivery{6, wire::Delivery::kNews});
  EXPECT_EQ(got(1), Items{});
  goTo(10);
  EXPECT_EQ(router_.nextLink(), kNever);
  act(1, wire::Send{5, 0, 0, "heard"});
  EXPECT_EQ(got(2), (Items{"publisher 6 1", "deliver 6 1 heard"}));
  due_ = 0;
  act(3, subscribe(7, "/x"));
  EXPECT_EQ(got(3), Items{"publisher 7 1"});
}

TEST_F(LateRouting, WhoHearsOfALateLinkHearsWhatItsSubscriberChose) {
  act(1, advertise(5, "/x"));
  act(2, subscribe(6, "/x"));
  act(2, wire::ChooseDelivery{6, wire::Delivery::kNews});
  goTo(10);
  EXPECT_EQ(got(1), (Items{"subscriber 5 2", "heard 1 5 2"}));
}

TEST_F(LateRouting, NobodyHearsOfALinkThatIsClosedBeforeItIsUp) {
  for (const bool by_publisher : {false, true}) {
    act(1, advertise(5, "/x"));
    act(2, subscribe(6, "/x"));
    act(by_publisher ? 1 : 2, by_publisher ? wire::ReportItem(wire::Unadvertise{5})
                                           : wire::ReportItem(wire::Unsubscribe{6}));
    EXPECT_EQ(router_.nextLink(), kNever);
    router_.finishRound();
    goTo(now_ + 20);
    EXPECT_EQ(got(1), Items{});
    EXPECT_EQ(got(2), Items{});
  }
  act(1, advertise(5, "/x"));
  act(2, subscribe(6, "/x"));
  router_.remove(2, 99);
  goTo(now_ + 20);
  EXPECT_EQ(got(1), Items{});
}

TEST_F(LateRouting, ALinkThatClosesAndIsUpAgainLaterIsClosedInBetween) {
  due_ = 0;
  act(1, advertise(5, "/x"));
  act(2, subscribe(6, "/x"));
  got(1);
  due_ = 10;
  act(2, wire::Unsubscribe{6});
  act(2, subscribe(6, "/x"));
  EXPECT_EQ(got(1), Items{"no subscriber 5 2"});
  goTo(10);
  EXPECT_EQ(got(2), Items{"publisher 6 1"});
}

}  // namespace
}  // namespace move_base_abstract::late_links_test
