#include "network.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <variant>

#include "clock/shown_text.h"
#include "patterns.h"

namespace move_base_abstract::radio {
namespace {

constexpr std::int32_t kMostCells = 1 << 15;  // along one side of a map
constexpr Nanoseconds kLongest = 1000 * kNanosecondsPerSecond;

/** @brief Reads the words of one line, and refuses a line that is wrong. */
class Words {
 public:
  explicit Words(const std::string& line) : line_(line), words_(line) {}

  bool more() { return (words_ >> std::ws).good(); }
  std::string text() {
    std::string word;
    if (!(words_ >> word)) {
      refuse();
    }
    return word;
  }
  std::vector<std::string> rest() {
    std::vector<std::string> all;
    while (more()) {
      all.push_back(text());
    }
    return all;
  }
  double number(double low, double high) {
    const std::string word = text();
    std::istringstream part(word);
    part.imbue(std::locale::classic());
    double value = 0.0;
    if (!(part >> value) || part.peek() != std::istringstream::traits_type::eof() ||
        !(value >= low && value <= high)) {
      refuse();
    }
    return value;
  }
  template <typename Whole>
  Whole whole(Whole low, Whole high) {
    std::istringstream part(text());
    part.imbue(std::locale::classic());
    Whole value = 0;
    if (!(part >> value) || part.peek() != std::istringstream::traits_type::eof() || value < low ||
        value > high) {
      refuse();
    }
    return value;
  }
  [[noreturn]] void refuse() const {
    throw std::invalid_argument(
        "network must be lines that the launcher or move_base_abstract.network makes of a "
        "network's file, got '" +
        shown(line_) + "'");
  }

 private:
  const std::string line_;
  std::istringstream words_;
};

constexpr double kFar = 1e12;  // m; for other numbers in their own units

HostRule hostOf(Words& words) {
  HostRule host;
  host.name = words.text();
  const std::string place = words.text();
  if (place == "at") {
    const double x = words.number(-kFar, kFar);
    host.at = Place{x, words.number(-kFar, kFar)};
  } else if (place != "robot") {
    words.refuse();
  }
  host.nodes = words.rest();
  return host;
}

LossTable tableOf(Words& words) {
  LossTable table;
  for (auto left = words.whole<std::int32_t>(1, 1000); left > 0; --left) {
    const double distance = words.number(0.0, kFar);
    if (!table.empty() && distance <= table.back().first) {
      words.refuse();
    }
    table.emplace_back(distance, words.number(0.0, 1.0));
  }
  return table;
}

PathLoss pathOf(Words& words) {
  PathLoss law{};
  law.power = words.number(-1000.0, 1000.0);
  law.sensitivity = words.number(-1000.0, 1000.0);
  law.exponent = words.number(0.0, 100.0);
  law.reference = words.number(1e-6, kFar);
  law.loss_at_reference = words.number(-1000.0, 1000.0);
  law.shadowing = words.number(0.0, 1000.0);
  return law;
}

OnLoss onLoss(Words& words) {
  const std::string word = words.text();
  if (word != "drop" && word != "retry" && word != "queue") {
    words.refuse();
  }
  return word == "drop" ? OnLoss::kDrop : word == "retry" ? OnLoss::kRetry : OnLoss::kQueue;
}

void readKey(Words& words, LinkRule& link) {
  const std::string key = words.text();
  if (key == "delay") {
    link.delay_low = words.whole<Nanoseconds>(0, kLongest);
    link.delay_high = words.whole<Nanoseconds>(link.delay_low, kLongest);
  } else if (key == "loss") {
    link.loss = words.number(0.0, 1.0);
  } else if (key == "table") {
    link.loss = tableOf(words);
  } else if (key == "path") {
    link.loss = pathOf(words);
  } else if (key == "rate") {
    link.rate = words.whole<std::int64_t>(1, 1'000'000'000'000);
  } else if (key == "buffer") {
    link.buffer = words.whole<std::int64_t>(1, 1'000'000'000'000);
  } else if (key == "range") {
    link.range = words.number(0.0, kFar);
  } else if (key == "wall") {
    link.wall = words.number(0.0, kFar);
  } else if (key == "lost") {
    link.lost = onLoss(words);
  } else if (key == "retry") {
    link.retry = words.whole<Nanoseconds>(1'000, kLongest);
  } else if (key == "attempts") {
    link.attempts = words.whole<std::uint32_t>(1, 64);
  } else {
    words.refuse();
  }
}

LinkRule linkOf(Words& words) {
  LinkRule link;
  link.one = words.text();
  link.other = words.text();
  while (words.more()) {
    readKey(words, link);
  }
  return link;
}

Walls wallsOf(Words& words) {
  const double x = words.number(-kFar, kFar);
  const double y = words.number(-kFar, kFar);
  const double cell = words.number(1e-3, 1e6);
  const auto width = words.whole<std::int32_t>(1, kMostCells);
  return {{x, y}, cell, width, words.whole<std::int32_t>(1, kMostCells)};
}

void readWalls(Words& words, Walls& walls) {
  const auto row = words.whole<std::int32_t>(0, kMostCells);
  while (words.more()) {
    const auto begin = words.whole<std::int32_t>(0, kMostCells);
    walls.add(row, begin, words.whole<std::int32_t>(begin + 1, kMostCells));
  }
}

void readLine(Words& words, Network& network) {
  const std::string what = words.text();
  if (what == "seed") {
    network.seed = words.whole<std::uint64_t>(0, ~std::uint64_t{0});
  } else if (what == "host") {
    network.hosts.push_back(hostOf(words));
  } else if (what == "link") {
    network.links.push_back(linkOf(words));
  } else if (what == "wired") {
    network.wired = words.rest();
  } else if (what == "walls") {
    network.walls = wallsOf(words);
  } else if (what == "wall") {
    readWalls(words, network.walls);
  } else {
    words.refuse();
  }
  if (words.more()) {
    words.refuse();
  }
}

}  // namespace

bool LinkRule::needsPlaces() const {
  return !std::holds_alternative<double>(loss) || !std::isinf(range);
}

bool Network::isWired(std::string_view name) const {
  return std::any_of(wired.begin(), wired.end(), [&](const std::string& pattern) {
    return matched(pattern, name).has_value();
  });
}

bool Network::hasWaiting() const {
  return std::any_of(links.begin(), links.end(),
                     [](const LinkRule& link) { return link.lost != OnLoss::kDrop; });
}

Network networkOf(const std::vector<std::string>& lines) {
  Network network;
  for (const std::string& line : lines) {
    Words words(line);
    readLine(words, network);
  }
  return network;
}

}  // namespace move_base_abstract::radio
