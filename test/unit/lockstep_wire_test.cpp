// Frames: what is written is read again, and nothing that is malformed gets through or does harm.
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "lockstep/wire/wire.h"

namespace move_base_abstract::wire {
namespace {

/** @return type and body of a whole frame. */
std::string_view body(const std::string& frame) { return std::string_view(frame).substr(4); }

template <typename Call>
std::string malformed(Call call) {
  try {
    call();
  } catch (const MalformedFrame& error) {
    return error.what();
  }
  return "was taken";
}

Report richReport() {
  Report report;
  report.round = 0x0102030405060708;
  report.leaving = true;
  report.next_ns = 1'500'000'000;
  report.open = 2;
  report.items = {Advertise{7, 3, "/x", "a/Type", "0123", true, "string data"},
                  Unadvertise{7},
                  Subscribe{8, 1, "/y", "*"},
                  Unsubscribe{8},
                  Send{7, 3, 9, std::string_view("\0\xFF", 2)},
                  Serve{1, 2, "/s"},
                  Unserve{1},
                  Call{5, 1, "/s", "request"},
                  Response{4, 5, true, ""},
                  Log{2, "robot_2", "arrived", "[1.5]"},
                  Note{NoteKind::kDegraded, "\xC3\xA9t\xC3\xA9 \xF0\x9F\x98\x80"},
                  Watch{"/s"},
                  At{2},
                  Rest{},
                  ChooseDelivery{7, Delivery::kNews},
                  Background{},
                  Parameter{"/x", true, "<value>1</value>"},
                  Asks{"/y"},
                  Idle{3},
                  KeepUntil{7},
                  Motion{1, "robot_1", "pieces"},
                  Play{7, 1, 2, true, 3, 4, 5, "payload", "slots"}};
  return report;
}

Grant richGrant() {
  return {
      17,
      kNever,
      3,
      {Publisher{1, 2, "a/Type", "0123", true, "string data"}, NoPublisher{1, 2}, Subscriber{1, 3},
       NoSubscriber{1, 3}, Deliver{1, 2, "payload"}, CallIn{4, 2, 9, "request"},
       Answer{9, CallStatus::kServerGone, ""}, Found{"/s"}, Happened{5},
       DeliveryChosen{1, 3, Delivery::kNothing}, Window{7, 5}, Arrives{6}, Came{5}, Changed{}}};
}

TEST(Wire, BytesOfAReportAreAsDescribed) {
  Report report;
  report.round = 0x0102;
  report.next_ns = 5;
  report.open = 1;
  report.items = {Send{7, 1, 0, "ab"}};
  const std::string expected(
      "\x2C\0\0\0\x02"
      "\x02\x01\0\0\0\0\0\0\0"
      "\x05\0\0\0\0\0\0\0\x01\0\0\0"
      "\x05\x07\0\0\0\x01\0\0\0\0\0\0\0\x02\0\0\0ab",
      4 + 1 + 9 + 12 + 1 + 12 + 4 + 2);
  std::string bytes = encode(ParticipantFrame(report));
  EXPECT_EQ(bytes.substr(4), expected.substr(4));
  EXPECT_EQ(bytes[0], static_cast<char>(expected.size() - 4));
}

TEST(Wire, EveryItemOfAReportComesBack) {
  const std::string frame = encode(ParticipantFrame(richReport()));
  const auto report = std::get<Report>(decodeFromParticipant(body(frame)));
  EXPECT_EQ(report.round, 0x0102030405060708U);
  EXPECT_TRUE(report.leaving);
  EXPECT_EQ(report.next_ns, 1'500'000'000);
  EXPECT_EQ(report.open, 2U);
  ASSERT_EQ(report.items.size(), std::variant_size_v<ReportItem>);
  for (std::size_t k = 0; k < report.items.size(); ++k) {
    EXPECT_EQ(report.items[k].index(), k);
  }
  const auto& advertise = std::get<Advertise>(report.items[0]);
  EXPECT_EQ(advertise.topic, 7U);
  EXPECT_EQ(advertise.sub, 3U);
  EXPECT_EQ(advertise.name, "/x");
  EXPECT_EQ(advertise.type, "a/Type");
  EXPECT_EQ(advertise.md5, "0123");
  EXPECT_TRUE(advertise.latched);
  EXPECT_EQ(advertise.definition, "string data");
  EXPECT_EQ(std::get<Send>(report.items[4]).payload, std::string_view("\0\xFF", 2));
  EXPECT_EQ(std::get<Log>(report.items[9]).values, "[1.5]");
  EXPECT_EQ(encode(ParticipantFrame(report)), frame);
}

TEST(Wire, EveryItemOfAGrantComesBack) {
  const std::string frame = encode(MasterFrame(richGrant()));
  const auto grant = std::get<Grant>(decodeFromMaster(body(frame)));
  EXPECT_EQ(grant.round, 17U);
  EXPECT_EQ(grant.time_ns, kNever);
  EXPECT_EQ(grant.microstep, 3U);
  ASSERT_EQ(grant.items.size(), std::variant_size_v<GrantItem>);
  EXPECT_EQ(std::get<Answer>(grant.items[6]).status, CallStatus::kServerGone);
  EXPECT_EQ(encode(MasterFrame(grant)), frame);
}

TEST(Wire, TheOtherFramesComeBack) {
  const std::vector<ParticipantFrame> up{
      Hello{kProtocol, "/a", "http://host:1/", -3, true, 7, "secret"}, Knock{}, Leave{"done"}};
  for (const ParticipantFrame& frame : up) {
    const std::string bytes = encode(frame);
    EXPECT_EQ(encode(decodeFromParticipant(body(bytes))), bytes);
  }
  const std::vector<MasterFrame> down{Welcome{3, -1, kNever, 8, {"/clock", ""}, true},
                                      Member{4, "/b", "uri"}, Gone{4}, End{"over"}};
  for (const MasterFrame& frame : down) {
    const std::string bytes = encode(frame);
    EXPECT_EQ(encode(decodeFromMaster(body(bytes))), bytes);
  }
  const std::string hello = encode(up[0]);
  EXPECT_EQ(std::get<Hello>(decodeFromParticipant(body(hello))).rank, -3);
}

TEST(Wire, OfAnotherVersionsHelloOnlyProtocolAndNameAreRead) {
  std::string hello = encode(ParticipantFrame(Hello{1, "/a", "", 0, true, 7, ""}));
  hello.resize(hello.size() - 12);  // version 1 ended before the secret
  const auto read = std::get<Hello>(decodeFromParticipant(body(hello)));
  EXPECT_EQ(read.protocol, 1U);
  EXPECT_EQ(read.name, "/a");
}

TEST(Wire, AFrameBuiltItemByItemIsTheSame) {
  const Report report = richReport();
  std::string items;
  for (const ReportItem& item : report.items) {
    append(items, item);
  }
  EXPECT_EQ(encodeReport(report, items), encode(ParticipantFrame(report)));
}

TEST(Wire, AFieldThatIsTooLongIsNamedWithItsPlace) {
  std::string frame = encode(ParticipantFrame(Leave{"done"}));
  frame[5] = '\x50';
  EXPECT_EQ(malformed([&] { decodeFromParticipant(body(frame)); }),
            "LEAVE: reason must fit into the frame, needs 80 bytes of 4 (byte 4 of 8)");
  frame.replace(5, 4, "\xFF\xFF\xFF\xFF");
  EXPECT_NE(malformed([&] { decodeFromParticipant(body(frame)); }).find("needs 4294967295 bytes"),
            std::string::npos);
}

TEST(Wire, WrongKindsAndValuesAreRefused) {
  const auto up = [](const std::string& bytes) {
    return malformed([&] { decodeFromParticipant(bytes); });
  };
  EXPECT_EQ(up(""), "a frame must have a type, got an empty one");
  EXPECT_EQ(up("\x09"), "type of frame must be from 1 to 8, got 9");
  EXPECT_EQ(up("\x13"), "type of frame must be from 1 to 8, got 19");
  EXPECT_EQ(up("\x03zz"), "KNOCK: end must come here, got more bytes (byte 0 of 2)");
  const auto patched = [&](const ReportItem& item, std::size_t at, char value) {
    std::string frame = encodeReport({}, "");
    append(frame, item);
    frame[at] = value;
    return up(frame.substr(4));
  };
  const std::size_t items = 4 + 1 + 8 + 1 + 8 + 4;
  EXPECT_NE(patched(Unserve{1}, items, '\x17').find("kind of item must be from 1 to 22, got 23"),
            std::string::npos);
  EXPECT_NE(patched(Unserve{1}, items, '\0').find("got 0"), std::string::npos);
  EXPECT_NE(patched(Note{}, items + 1, '\x08').find("NOTE: what must be from 1 to 7, got 8"),
            std::string::npos);
  EXPECT_NE(patched(Response{}, items + 9, '\x02').find("ok must be from 0 to 1, got 2"),
            std::string::npos);
  EXPECT_NE(patched(Unserve{1}, 4 + 1 + 8, '\x02').find("leaving must be from 0 to 1, got 2"),
            std::string::npos);
  EXPECT_NE(patched(Unserve{1}, 4 + 1 + 8 + 1 + 7, '\x80').find("next_ns must not be negative"),
            std::string::npos);
}

TEST(Wire, TextIsUtf8AndPayloadsAreAnything) {
  const std::vector<std::string> bad{"\xFF", "\xC3", "\xC0\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80",
                                     "a\x80"};
  for (const std::string& text : bad) {
    const std::string frame = encode(ParticipantFrame(Leave{text}));
    EXPECT_NE(malformed([&] { decodeFromParticipant(body(frame)); }).find("must be UTF-8"),
              std::string::npos);
    Report report;
    report.items = {Send{1, 0, 0, text}};
    const std::string sent = encode(ParticipantFrame(report));
    EXPECT_NO_THROW(decodeFromParticipant(body(sent)));
  }
}

TEST(Wire, EveryTruncationOfAReportIsRefusedOrShorter) {
  const std::string frame = encode(ParticipantFrame(richReport()));
  const std::size_t whole = body(frame).size();
  std::size_t refused = 0;
  for (std::size_t size = 0; size < whole; ++size) {
    try {
      const auto report = std::get<Report>(decodeFromParticipant(body(frame).substr(0, size)));
      EXPECT_LT(report.items.size(), richReport().items.size());
    } catch (const MalformedFrame&) {
      ++refused;
    }
  }
  EXPECT_EQ(refused, whole - richReport().items.size());  // only between items it may end
}

TEST(Wire, RandomDamageNeverDoesMoreThanRefuse) {
  std::mt19937 random(1);
  const std::string up = encode(ParticipantFrame(richReport()));
  const std::string down = encode(MasterFrame(richGrant()));
  int refused = 0;
  for (int k = 0; k < 20'000; ++k) {
    std::string frame(body(k % 2 == 0 ? up : down));
    for (unsigned n = 1 + random() % 4; n > 0; --n) {
      frame[random() % frame.size()] = static_cast<char>(random());
    }
    frame.resize(frame.size() - random() % 2 * (random() % frame.size()));
    try {
      if (k % 2 == 0) {
        decodeFromParticipant(frame);
      } else {
        decodeFromMaster(frame);
      }
    } catch (const MalformedFrame&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 10'000);
}

TEST(FrameBuffer, PutsTogetherWhatWasCutAnywhere) {
  std::string all;
  for (int k = 0; k < 5; ++k) {
    all += encode(ParticipantFrame(Leave{std::string(static_cast<std::size_t>(k), 'x')}));
  }
  for (std::size_t piece = 1; piece < all.size(); ++piece) {
    FrameBuffer buffer;
    int frames = 0;
    for (std::size_t at = 0; at < all.size(); at += piece) {
      buffer.append(std::string_view(all).substr(at, piece));
      while (const auto frame = buffer.next()) {
        const auto leave = std::get<Leave>(decodeFromParticipant(*frame));
        EXPECT_EQ(leave.reason.size(), static_cast<std::size_t>(frames));
        ++frames;
      }
    }
    EXPECT_EQ(frames, 5);
    EXPECT_EQ(buffer.waiting(), 0U);
  }
}

TEST(FrameBuffer, RefusesHugeAndEmptyLengthsBeforeTheBytesCome) {
  for (const std::string& length : {std::string(4, '\0'), std::string(4, '\xFF')}) {
    FrameBuffer buffer;
    buffer.append(length.substr(0, 3));
    EXPECT_FALSE(buffer.next());
    buffer.append(length.substr(3));
    EXPECT_NE(malformed([&] { buffer.next(); }).find("length must be from 1 to 268435456"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace move_base_abstract::wire
