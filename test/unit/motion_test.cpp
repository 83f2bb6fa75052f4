// Motions in closed form: the table of cases that Python's evaluator is held to, too; and motions
// as bytes.
#include "motion/motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "radio_motion.h"

namespace move_base_abstract::motion {
namespace {

constexpr Nanoseconds kSecond = kNanosecondsPerSecond;

TEST(Motion, PosesAndVelocitiesAreThoseOfTheTable) {
  std::ifstream file(PIECES);
  const nlohmann::json cases = nlohmann::json::parse(file).at("cases");
  ASSERT_FALSE(cases.empty());
  for (const auto& one : cases) {
    std::string bytes;
    double error = 0.0;  // the last bit of exp differs from one computer to the next
    for (const auto& given : one.at("pieces")) {
      const auto numbers = given.get<std::vector<double>>();
      bytes += piece(given[0].get<Nanoseconds>(), {numbers.begin() + 1, numbers.end()});
      error = numbers.back() <= 0.0 ? error : 1e-13;
    }
    const Motion motion(bytes);
    for (const auto& asked : one.at("asked")) {
      const auto now = asked[0].get<Nanoseconds>();
      const Pose pose = motion.poseAt(now);
      const Velocity velocity = motion.velocityAt(now);
      const double found[] = {pose.x,           pose.y,           pose.yaw,
                              velocity.forward, velocity.lateral, velocity.turning};
      for (std::size_t k = 0; k < 6; ++k) {
        const double expected = asked[k + 1].get<double>();
        EXPECT_LE(std::fabs(found[k] - expected), error * std::max(1.0, std::fabs(expected)))
            << one.at("motion") << " at " << now << ": " << k;
      }
    }
  }
}

TEST(Motion, ThePiecesFollowEachOther) {
  const Motion motion(piece(kSecond, {1, 2, 0, 0.6, 0.8, 5, -1, 0, 0}) +
                      piece(3 * kSecond, {5.8, 8.4, 1, 1, 0, 0, 0, 0.5, 0}) +
                      piece(4 * kSecond, {5.8, 8.4, 1.5, 1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(motion.poseAt(0).x, 1.0);
  EXPECT_EQ(motion.velocityAt(0).forward, 0.0);
  EXPECT_EQ(motion.poseAt(2 * kSecond).x, 1 + 4.5 * 0.6);
  EXPECT_EQ(motion.velocityAt(2 * kSecond).forward, 4.0);
  EXPECT_EQ(motion.poseAt(3 * kSecond + kSecond / 2).yaw, 1.25);
  EXPECT_EQ(motion.poseAt(30 * kSecond).yaw, 1.5);
  EXPECT_EQ(motion.end(), 4 * kSecond);
  EXPECT_EQ(Motion(piece(0, {1, 0, 0, 1, 0, 2, 0, 0, 0})).end(), kNever);
}

TEST(Motion, BytesThatAreNoneAreRefused) {
  const std::vector<double> rest = {1, 2, 0, 1, 0, 0, 0, 0, 0};
  for (const std::string& bytes :
       {std::string(), std::string("12345678"), piece(5, {0, 0, 0, 1, 0, 0, 0, 0, NAN}),
        piece(-1, rest), piece(5, rest) + piece(5, rest)}) {
    EXPECT_THROW(Motion{bytes}, std::invalid_argument);
  }
}

}  // namespace
}  // namespace move_base_abstract::motion

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
