#include "report_delay.h"

#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cstdlib>
#include <regex>

#include "link.h"

namespace move_base_abstract::lockstep::internal {
namespace {

constexpr const char* kVariable = "MOVE_BASE_ABSTRACT_REPORT_DELAY";
constexpr const char* kFirstVariable = "MOVE_BASE_ABSTRACT_FIRST_TURNS";
constexpr std::uint64_t kOneIn = 16;
constexpr std::uint64_t kDelayUnit = 1'000'000;   // ns, a millisecond
constexpr std::uint64_t kSecond = 1'000'000'000;  // ns

/**
 * @return whether the variable is set, and its two numbers. @throws Error if it has another form.
 */
bool read(const char* variable, const char* form, std::string* first, std::uint64_t* milliseconds) {
  const char* const text = std::getenv(variable);
  if (text == nullptr || *text == '\0') {
    return false;
  }
  std::cmatch found;
  if (!std::regex_match(text, found, std::regex("([0-9]{1,9}):([0-9]{1,4})"))) {
    throw Error(std::string("lockstep: the environment variable ") + variable + " must be " + form +
                ", whole numbers of at most 9 and 4 digits, got '" +
                std::string(text).substr(0, 100) + "'");
  }
  *first = found[1].str();
  *milliseconds = std::stoull(found[2].str());
  return true;
}

/**
 * Sleep by a system call, since the sleeps of libc belong to the program and take simulated time.
 */
void sleepFor(std::uint64_t nanoseconds) {
  timespec time{};
  time.tv_sec = static_cast<time_t>(nanoseconds / kSecond);
  time.tv_nsec = static_cast<long>(nanoseconds % kSecond);
  ::syscall(SYS_nanosleep, &time, nullptr);
}

}  // namespace

void ReportDelay::prepare(const std::string& name) {
  std::string number;
  std::uint64_t milliseconds = 0;
  if (read(kVariable, "SEED:MILLISECONDS", &number, &milliseconds)) {
    const std::string start = number + name;
    std::seed_seq seed(start.begin(), start.end());
    chance_.seed(seed);
    longest_ns_ = milliseconds * kDelayUnit;
  }
  if (read(kFirstVariable, "COUNT:MILLISECONDS", &number, &milliseconds)) {
    turns_ = std::stoull(number);
    late_ns_ = milliseconds * kDelayUnit;
  }
}

void ReportDelay::wait() {
  if (longest_ns_ != 0 && chance_() % kOneIn == 0) {
    sleepFor(chance_() % longest_ns_);
  }
}

void ReportDelay::begin() {
  if (turns_ > 0) {
    --turns_;
    sleepFor(late_ns_);
  }
}

}  // namespace move_base_abstract::lockstep::internal
