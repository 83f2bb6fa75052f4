// Connections that nobody knows yet: what they may send, for how long, and what is shown of it.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "clock/shown_text.h"
#include "lockstep_client.h"

namespace move_base_abstract::lockstep_strangers_test {
namespace {

using Texts = std::vector<std::string>;

int countOf(const Stage& stage, const std::string& text) {
  int count = 0;
  for (const LockstepMessage& message : stage.messages) {
    count += message.text.find(text) != std::string::npos ? 1 : 0;
  }
  return count;
}

TEST(Strangers, MaySendAFrameOfAHellosSizeOnly) {
  Stage stage(named({"/a"}));
  stage.session.connect(1, 0);
  stage.bytes(1, std::string("\x01\x10\0\0", 4));  // 4097 bytes are to follow
  EXPECT_EQ(stage.end[1], "frame: length must be from 1 to 4096, got 4097 (byte 4 of 4)");
  stage.join(2, "/a");
  stage.grant(2);
  stage.report(2, kNever, {advertise(1, "/x"), wire::Send{1, 0, 0, std::string(100'000, 'x')}});
  EXPECT_FALSE(stage.closed[2]);
}

TEST(Strangers, AreSentAwayWhenTheyHaveSaidNothingForLong) {
  Stage stage(named({"/a"}));
  stage.session.connect(1, 0);
  stage.wall = 3 * kSecond;
  stage.session.connect(2, stage.wall);
  stage.join(3, "/a");
  EXPECT_EQ(stage.session.strangers(), 2U);
  EXPECT_EQ(stage.session.nextWake(), 10 * kSecond);
  stage.wall = 10 * kSecond;
  stage.poll();
  EXPECT_EQ(stage.end[1], "it has said no HELLO within 10 s");
  EXPECT_FALSE(stage.closed[2]);
  EXPECT_EQ(stage.session.strangers(), 1U);
  stage.cut(2);
  EXPECT_EQ(stage.session.strangers(), 0U);
  stage.wall = 100 * kSecond;
  stage.poll();
  EXPECT_FALSE(stage.closed[3]);
}

TEST(Strangers, DoNotFillTheLog) {
  Stage stage(named({"/a"}));
  for (ConnectionId id = 1; id <= 1000; ++id) {
    stage.session.connect(id, 0);
    stage.frame(id, wire::Knock{});
    stage.cut(id);
  }
  EXPECT_EQ(countOf(stage, "a connection was refused: the first frame must be HELLO"), 10);
  EXPECT_EQ(countOf(stage, "a connection was refused (512 so far)"), 1);
  EXPECT_EQ(countOf(stage, "a connection was refused"), 16);
}

TEST(Strangers, NeedTheSecretWhereThereIsOne) {
  LockstepSettings settings = named({"/a"});
  settings.secret = "abc";
  Stage stage(settings);
  for (const char* wrong : {"", "ab", "abcd", "abd", "abcabc"}) {
    stage.secret = wrong;
    const auto id = static_cast<ConnectionId>(stage.end.size() + 1);
    stage.join(id, "/a");
    EXPECT_NE(stage.end[id].find("HELLO must have the secret of the run"), std::string::npos)
        << wrong;
  }
  EXPECT_TRUE(stage.session.status().participants.empty());
  stage.secret = "abc";
  stage.join(20, "/a");
  EXPECT_EQ(stage.session.status().participants.size(), 1U);
  EXPECT_EQ(stage.point(20), "1000+0");
}

TEST(Strangers, NamesHaveALimitAndNoControlCharacters) {
  Stage stage(named({"/a"}));
  stage.join(1, "/" + std::string(254, 'x'));
  EXPECT_FALSE(stage.closed[1]);
  stage.join(2, "/" + std::string(255, 'x'));
  EXPECT_NE(stage.end[2].find("at most 255 bytes"), std::string::npos);
  stage.join(3, "/a\x1b[2J");
  EXPECT_EQ(stage.end[3],
            "HELLO must have a name of at most 255 bytes without control characters, got "
            "'/a\\x1b[2J'");
  EXPECT_TRUE(stage.said("got '/a\\x1b[2J'"));
}

TEST(Shown, WhatParticipantsSayIsQuotedAndHasALimit) {
  Stage stage(named({"/a"}));
  stage.join(1, "/a");
  stage.grant(1);
  stage.report(1, kNever,
               {wire::Note{wire::NoteKind::kWaitsFor, "a\nb\x1b"},
                wire::Note{wire::NoteKind::kDegraded, "c\x7f\xc2\x9b\xe2\x80\xae"},
                wire::Note{wire::NoteKind::kNotRepeatable, std::string(100'000, 'x')},
                wire::Watch{"/w"}, wire::Send{1, 0, 0, ""}},
               1);
  const LockstepStatus status = stage.session.status();
  EXPECT_EQ(status.degraded.back(), "'/a': c\\x7f\\x9b\\u202e");
  EXPECT_LT(status.not_repeatable[0].size(), 2100U);
  for (const LockstepMessage& message : stage.messages) {
    EXPECT_FALSE(hasControlCharacters(message.text)) << message.text;
  }
}

TEST(Shown, WaitsAreQuotedInTheStateOfADeadlock) {
  Stage stage(named({"/a"}));
  stage.join(1, "/a");
  stage.grant(1);
  stage.report(1, kNever, {wire::Note{wire::NoteKind::kWaitsFor, "a\nb"}}, 1);
  EXPECT_EQ(stage.session.status().participants[0].waits_for, "a\\x0ab");
  EXPECT_FALSE(hasControlCharacters(stage.session.status().reason));
}

TEST(Shown, LabelsHaveALimit) {
  Stage stage(named({"/a"}));
  stage.join(1, "/a");
  stage.grant(1);
  std::vector<std::string> texts;
  for (int k = 0; k < 1000; ++k) {
    texts.push_back(std::to_string(k));
  }
  std::vector<wire::ReportItem> notes;
  for (const std::string& text : texts) {
    notes.emplace_back(wire::Note{wire::NoteKind::kNotRepeatable, text});
  }
  stage.report(1, kNever, notes);
  const Texts labels = stage.session.status().not_repeatable;
  EXPECT_EQ(labels.size(), 101U);
  EXPECT_EQ(labels.back(), "and more; only the first are listed");
}

TEST(Shown, Texts) {
  EXPECT_EQ(shown("plain \xc3\xa4 \xf0\x9f\xa4\x96"), "plain \xc3\xa4 \xf0\x9f\xa4\x96");
  EXPECT_EQ(shown(std::string_view("\0\t\x7f", 3)), "\\x00\\x09\\x7f");
  EXPECT_EQ(shown("\x9b\xc2"), "\\x9b\xc2");  // no UTF-8: the first commands terminals of 8 bits
  EXPECT_EQ(shown("abcdef", 3), "abc... (6 bytes)");
  EXPECT_EQ(shown("ab\xc3\xa4", 3), "ab... (4 bytes)");  // no half characters
  EXPECT_FALSE(hasControlCharacters("\xc3\xa4 b"));
  EXPECT_TRUE(hasControlCharacters("a\xe2\x80\xa8"));
}

}  // namespace
}  // namespace move_base_abstract::lockstep_strangers_test
