#include "report_delay.h"

#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cstdlib>
#include <regex>

#include "move_base_abstract/lockstep_participant.h"

namespace move_base_abstract::lockstep::internal {
namespace {

constexpr const char* kVariable = "MOVE_BASE_ABSTRACT_REPORT_DELAY";
constexpr std::uint64_t kOneIn = 16;
constexpr std::uint64_t kMillisecond = 1'000'000;  // ns
constexpr std::uint64_t kSecond = 1'000'000'000;   // ns

}  // namespace

void ReportDelay::prepare(const std::string& name) {
  const char* const text = std::getenv(kVariable);
  if (text == nullptr || *text == '\0') {
    return;
  }
  std::cmatch found;
  if (!std::regex_match(text, found, std::regex("([0-9]{1,9}):([0-9]{1,4})"))) {
    throw Error(std::string("lockstep: the environment variable ") + kVariable +
                " must be SEED:MILLISECONDS, whole numbers of at most 9 and 4 digits, got '" +
                std::string(text).substr(0, 100) + "'");
  }
  const std::string start = found[1].str() + name;
  std::seed_seq seed(start.begin(), start.end());
  chance_.seed(seed);
  longest_ns_ = std::stoull(found[2].str()) * kMillisecond;
}

void ReportDelay::wait() {
  if (longest_ns_ == 0 || chance_() % kOneIn != 0) {
    return;
  }
  const std::uint64_t nanoseconds = chance_() % longest_ns_;
  timespec time{};
  time.tv_sec = static_cast<time_t>(nanoseconds / kSecond);
  time.tv_nsec = static_cast<long>(nanoseconds % kSecond);
  // The system's own: libc's sleeps are those of the program, which take simulated time.
  ::syscall(SYS_nanosleep, &time, nullptr);
}

}  // namespace move_base_abstract::lockstep::internal
