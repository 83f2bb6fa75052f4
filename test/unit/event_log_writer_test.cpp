// The event log's writer: what counts as a JSON array, lines, names of files, the end.
#include "event_log_writer.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

using move_base_abstract::EventLogWriter;
using move_base_abstract::isJsonArray;

namespace {

class Folder {
 public:
  Folder() { path_ = mkdtemp(template_); }
  ~Folder() {
    for (const char* name : {"/a.jsonl", "/a.csv", "/a.jsonl.part", "/a.csv.part"}) {
      unlink((path_ + name).c_str());
    }
    rmdir(path_.c_str());
  }
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  char template_[32] = "/tmp/event_log_XXXXXX";
  std::string path_;
};

std::string contents(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

bool exists(const std::string& path) { return access(path.c_str(), F_OK) == 0; }

}  // namespace

TEST(JsonArray, Arrays) {
  for (const char* good :
       {"[]", "[1]", " [ 1 , -2.5e+3 , 0 ] ", "[\"a\\\"b\\u00e4\\n\",true,false,null]",
        "[[],{},[{\"a\":[1,{\"b\":2}]}]]", "[\"\xc3\xa4\"]", "[0.5,1E9,-0]"}) {
    EXPECT_TRUE(isJsonArray(good)) << good;
  }
}

TEST(JsonArray, OtherThings) {
  for (const char* bad :
       {"",          "1",          "{}",        "\"[]\"",        "[",        "]",
        "[1",        "[1,]",       "[,1]",      "[1 2]",         "[01]",     "[1.]",
        "[.5]",      "[-]",        "[1e]",      "[+1]",          "[NaN]",    "[Infinity]",
        "[tru]",     "[\"a]",      "[\"\\x\"]", "[\"\\u12g4\"]", "[\"\n\"]", "[{1:2}]",
        "[{\"a\"}]", "[{\"a\":}]", "[] []",     "[]x",           "[\"\\"}) {
    EXPECT_FALSE(isJsonArray(bad)) << bad;
  }
  EXPECT_FALSE(isJsonArray(std::string("[1\0]", 4)));
  EXPECT_FALSE(isJsonArray(std::string(1'000'000, '[')));  // no deep recursion
}

TEST(EventLogWriter, JsonLines) {
  const Folder folder;
  EventLogWriter log(folder / "a.jsonl", 5);
  log.add(7, "robot \"1\"\n", "a\\b", "[1,\n\"x\"]");
  log.add(8, "r", "k", "no \"JSON\"");
  EXPECT_FALSE(exists(folder / "a.jsonl"));
  log.flush();
  const std::string head = "{\"event_log\":1,\"start_ns\":5}\n";
  const std::string events =
      "{\"time_ns\":7,\"robot\":\"robot \\\"1\\\" \",\"kind\":\"a\\\\b\",\"values\":[1, \"x\"]}\n"
      "{\"time_ns\":8,\"robot\":\"r\",\"kind\":\"k\",\"values\":[\"no \\\"JSON\\\"\"]}\n";
  EXPECT_EQ(contents(folder / "a.jsonl.part"), head + events);
  EXPECT_EQ(log.finish({"over", {"why\t1", "2"}, {}}), "");
  EXPECT_EQ(contents(folder / "a.jsonl"),
            head + events +
                "{\"end\":{\"events\":2,\"repeatable\":false,\"not_repeatable_because\":"
                "[\"why\\u00091\",\"2\"],\"degraded_because\":[],\"reason\":\"over\"}}\n");
  EXPECT_FALSE(exists(folder / "a.jsonl.part"));
}

TEST(EventLogWriter, Csv) {
  const Folder folder;
  EventLogWriter log(folder / "a.csv", 5);
  log.add(-7, "a \"b\", c", "k", "[]");
  EXPECT_EQ(log.finish({"over", {}, {"died"}}), "");
  EXPECT_EQ(contents(folder / "a.csv"),
            "# {\"event_log\":1,\"start_ns\":5}\ntime_ns,robot,kind,values\n"
            "-7,\"a \"\"b\"\", c\",k,[]\n"
            "# {\"end\":{\"events\":1,\"repeatable\":true,\"not_repeatable_because\":[],"
            "\"degraded_because\":[\"died\"],\"reason\":\"over\"}}\n");
}

TEST(EventLogWriter, RefusesOtherEndingsAndPathsThatCannotBeWritten) {
  EXPECT_THROW(EventLogWriter("/tmp/a.txt", 0), std::invalid_argument);
  EXPECT_THROW(EventLogWriter("", 0), std::invalid_argument);
  EXPECT_THROW(EventLogWriter("/none/a.csv", 0), std::invalid_argument);
}

TEST(EventLogWriter, AFullDiskIsToldAndTheFileKeepsTheNameOfAnUnfinishedOne) {
  const Folder folder;
  ASSERT_EQ(symlink("/dev/full", (folder / "a.csv.part").c_str()), 0);
  EventLogWriter log(folder / "a.csv", 0);
  EXPECT_NE(log.error().find("No space left"), std::string::npos) << log.error();
  log.add(1, "r", "k", "[]");
  EXPECT_NE(log.finish({"over", {}, {}}), "");
  EXPECT_FALSE(exists(folder / "a.csv"));
}

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
