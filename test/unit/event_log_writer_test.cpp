// The event log's writer: what counts as a JSON array, lines, names of files, the end.
#include "time_master/event_log_writer.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "time_master/new_file.h"

using move_base_abstract::EventLogWriter;
using move_base_abstract::isJsonArray;
using move_base_abstract::writeNewFile;

namespace {

class Folder {
 public:
  Folder() { path_ = mkdtemp(template_); }
  ~Folder() {
    for (const char* name : {"/a.jsonl", "/a.csv", "/a.jsonl.part", "/a.csv.part", "/other"}) {
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

void write(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

/** @return why a log at @p path is refused. */
std::string refused(const std::string& path) {
  try {
    EventLogWriter(path, 0);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

/** @brief As on a full disk: no file grows beyond @p size bytes. */
class FullDisk {
 public:
  explicit FullDisk(rlim_t size) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{size, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

const std::string kHead = "{\"event_log\":1,\"start_ns\":5}\n";

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

TEST(NewFile, IsThereWhenItIsWholeAndReplacesNothing) {
  const Folder folder;
  EXPECT_EQ(writeNewFile("note", folder / "a.csv", "first"), "");
  EXPECT_EQ(writeNewFile("note", folder / "a.csv", "second"),
            "note " + (folder / "a.csv") + ": File exists");
  EXPECT_EQ(contents(folder / "a.csv"), "first");
  {
    const FullDisk disk(3);
    EXPECT_NE(writeNewFile("note", folder / "other", "longer"), "");
  }
  EXPECT_FALSE(exists(folder / "other") || exists(folder / "other.part") ||
               exists(folder / "a.csv.part"));
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
                "[\"why\\u00091\",\"2\"],\"degraded_because\":[],\"reason\":\"over\","
                "\"by_fault\":false}}\n");
  EXPECT_FALSE(exists(folder / "a.jsonl.part"));
}

TEST(EventLogWriter, Csv) {
  const Folder folder;
  EventLogWriter log(folder / "a.csv", 5);
  log.add(-7, "a \"b\", c", "k", "[]");
  EXPECT_EQ(log.finish({"over", {}, {"died"}, true, {}, {{"/a", 3, true}, {"/b", 4, false}}}), "");
  EXPECT_EQ(contents(folder / "a.csv"),
            "# {\"event_log\":1,\"start_ns\":5}\ntime_ns,robot,kind,values\n"
            "-7,\"a \"\"b\"\", c\",k,[]\n"
            "# {\"end\":{\"events\":1,\"repeatable\":true,\"not_repeatable_because\":[],"
            "\"degraded_because\":[\"died\"],\"reason\":\"over\",\"by_fault\":true,"
            "\"departures\":[{\"node\":\"/a\",\"time_ns\":3,\"died\":true},"
            "{\"node\":\"/b\",\"time_ns\":4,\"died\":false}]}}\n");
}

TEST(EventLogWriter, SaysInCodesWhatHasEndedARun) {
  const Folder folder;
  EventLogWriter log(folder / "a.jsonl", 0);
  EventLogWriter::End end{"'/a' left", {}, {}};
  end.ended_by = "departure";
  end.ended_with = "/a\"";
  end.at_ns = 7;
  EXPECT_EQ(log.finish(end), "");
  EXPECT_NE(contents(folder / "a.jsonl")
                .find(",\"by_fault\":false,\"ended_by\":\"departure\",\"node\":\"/a\\\"\","
                      "\"at_ns\":7}}"),
            std::string::npos);
}

TEST(EventLogWriter, RefusesOtherEndingsAndPathsThatCannotBeWritten) {
  EXPECT_THROW(EventLogWriter("/tmp/a.txt", 0), std::invalid_argument);
  EXPECT_THROW(EventLogWriter("", 0), std::invalid_argument);
  EXPECT_THROW(EventLogWriter("/none/a.csv", 0), std::invalid_argument);
}

TEST(EventLogWriter, ALogThatWasCutSaysWhereAndIsNotCalledRepeatable) {
  const Folder folder;
  EventLogWriter log(folder / "a.jsonl", 0);
  EXPECT_EQ(log.finish({"told to end", {}, {}, false, 12'300'000'000}), "");
  EXPECT_NE(contents(folder / "a.jsonl").find("\"repeatable\":false"), std::string::npos);
  EXPECT_NE(contents(folder / "a.jsonl").find(",\"by_fault\":false,\"cut_ns\":12300000000}}"),
            std::string::npos);
}

TEST(EventLogWriter, AFullDiskIsToldAndTheFileKeepsTheNameOfAnUnfinishedOne) {
  const Folder folder;
  std::string error, at_end;
  {
    const FullDisk disk(100);
    EventLogWriter log(folder / "a.csv", 0);
    log.add(1, "r", "k", "[\"" + std::string(100, 'x') + "\"]");
    log.flush();
    error = log.error();
    at_end = log.finish({"over", {}, {}});
  }
  EXPECT_EQ(error, "event log " + (folder / "a.csv.part") +
                       " cannot be written: File too large; it ends there");
  EXPECT_EQ(at_end, error);
  EXPECT_FALSE(exists(folder / "a.csv"));
  EXPECT_EQ(contents(folder / "a.csv.part").size(), 100U);
}

// ---- what is there already -------------------------------------------------------------------

TEST(EventLogWriter, ReplacesEventLogsOfEitherFormatAndUnfinishedOnes) {
  const Folder folder;
  write(folder / "a.jsonl", kHead);
  write(folder / "a.jsonl.part", "# " + kHead);
  EventLogWriter log(folder / "a.jsonl", 6);
  EXPECT_EQ(contents(folder / "a.jsonl"), kHead);
  EXPECT_EQ(log.finish({"over", {}, {}}), "");
  EXPECT_EQ(contents(folder / "a.jsonl").find("{\"event_log\":1,\"start_ns\":6}"), 0U);
}

TEST(EventLogWriter, ReplacesWhatAFullDiskHasLeft) {
  for (const std::string text : {"", "{\"event", "# {"}) {
    const Folder folder;
    write(folder / "a.jsonl.part", text);
    EXPECT_EQ(refused(folder / "a.jsonl"), "");
  }
}

TEST(EventLogWriter, ReplacesNothingElse) {
  const Folder empty;
  write(empty / "a.jsonl", "");
  EXPECT_NE(refused(empty / "a.jsonl").find("is no event log"), std::string::npos);
  for (const char* text : {"{\"event\":1}\n", "thesis", "# []"}) {
    for (const char* name : {"a.jsonl", "a.jsonl.part"}) {
      const Folder folder;
      write(folder / name, text);
      EXPECT_EQ(refused(folder / "a.jsonl"),
                "must be a path that can be written, got '" + (folder / "a.jsonl") + "': " +
                    (folder / name) + " is there already and is no event log: it is not replaced");
      EXPECT_EQ(contents(folder / name), text);
    }
  }
  const Folder folder;
  ASSERT_EQ(mkfifo((folder / "a.csv.part").c_str(), 0600), 0);
  EXPECT_NE(refused(folder / "a.csv").find("is no event log"), std::string::npos);
}

TEST(EventLogWriter, FollowsNoSymbolicLink) {
  for (const char* name : {"a.jsonl", "a.jsonl.part"}) {
    for (const bool dangling : {false, true}) {
      const Folder folder;
      if (!dangling) {
        write(folder / "other", kHead);
      }
      ASSERT_EQ(symlink((folder / "other").c_str(), (folder / name).c_str()), 0);
      EXPECT_NE(refused(folder / "a.jsonl").find("is a symbolic link, which is not followed"),
                std::string::npos);
      EXPECT_EQ(exists(folder / "other"), !dangling);
    }
  }
}

TEST(EventLogWriter, LeavesAloneWhatHasComeDuringTheRun) {
  const Folder folder;
  EventLogWriter log(folder / "a.jsonl", 5);
  write(folder / "a.jsonl", "thesis");
  EXPECT_NE(log.finish({"over", {}, {}}).find("cannot be given its name"), std::string::npos);
  EXPECT_EQ(contents(folder / "a.jsonl"), "thesis");
  EXPECT_EQ(contents(folder / "a.jsonl.part").find(kHead), 0U);
}

TEST(EventLogWriter, DoesNotTakeTheFileOfOneThatStillWrites) {
  const Folder folder;
  EventLogWriter log(folder / "a.jsonl", 5);
  EXPECT_NE(refused(folder / "a.jsonl").find("is being written by another process"),
            std::string::npos);
  EXPECT_EQ(log.finish({"over", {}, {}}), "");
  EXPECT_EQ(refused(folder / "a.jsonl"), "");
}

TEST(EventLogWriter, AnOtherNameOfAnUnfinishedLogKeepsItsContents) {
  const Folder folder;
  write(folder / "other", kHead);
  ASSERT_EQ(link((folder / "other").c_str(), (folder / "a.jsonl.part").c_str()), 0);
  EXPECT_EQ(refused(folder / "a.jsonl"), "");
  EXPECT_EQ(contents(folder / "other"), kHead);
}

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
