// Whether a run goes faster on one core or on all: a rule that is fed with what rounds took.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_CORE_CHOICE_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_CORE_CHOICE_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "clock/scaled_clock.h"

namespace move_base_abstract {

/** @brief What the user wants; kAlternate changes every few rounds, which only tests want. */
enum class CoresWish { kAuto, kOne, kAll, kAlternate };

/** @brief What rounds took, apart by how many participants were granted: only such are alike. */
class RoundCosts {
 public:
  void add(std::size_t grants, Nanoseconds duration);
  RoundCosts& operator+=(const RoundCosts& other);

  std::uint64_t rounds() const { return rounds_; }
  Nanoseconds time() const { return time_; }
  /** @return what these cost relative to @p others for the same mixture of rounds; 0: they have
   * none in common. */
  double relativeTo(const RoundCosts& others) const;
  /** @return how much of these rounds' time went to such that are in @p others, 0 to 1. */
  double shareIn(const RoundCosts& others) const;

 private:
  struct Cell {
    std::uint64_t rounds = 0;
    Nanoseconds time = 0;
  };

  std::array<Cell, 16> cells_{};
  std::uint64_t rounds_ = 0;
  Nanoseconds time_ = 0;
};

/**
 * @brief Measures short spans of rounds on one core and on all in turn, keeps the better, and looks
 * again later, or when rounds cost something else.
 *
 * A look ends when its outcome hangs on no single pair of spans. Looks cost at most a fiftieth of
 * the time, but for the first.
 */
class CoreChoice {
 public:
  explicit CoreChoice(CoresWish wish) : wish_(wish), is_one_(wish == CoresWish::kOne) {}

  /** @return whether the next round is to be on one core. */
  bool isOne() const { return is_one_; }
  /** @return what is kept while no look is under way. */
  bool keepsOne() const { return keeps_one_; }
  bool isLooking() const { return is_looking_; }
  /** @return whether the look under way began because rounds had come to cost more. */
  bool isDearer() const { return is_dearer_; }

  /**
   * @brief A round is over.
   * @param grants participants that worked in it; @param duration ns, wall;
   * @param wall the present, ns.
   */
  void add(std::size_t grants, Nanoseconds duration, Nanoseconds wall);
  /** @brief The change that add() has asked for took so long. */
  void addChange(Nanoseconds duration) { spent_ += duration; }

 private:
  struct Pair {
    RoundCosts one;
    RoundCosts all;
  };
  enum class Better { kOne, kAll, kNeither };

  void beginLook();
  void look(std::size_t grants, Nanoseconds duration, Nanoseconds wall);
  void watch(std::size_t grants, Nanoseconds duration, Nanoseconds wall);
  void use(bool one);
  static Better better(double cost_of_one);
  double costOfOne(std::size_t without) const;
  bool isClear() const;
  void settle(Nanoseconds wall);

  const CoresWish wish_;
  bool is_one_;
  bool keeps_one_ = false;
  bool is_looking_ = false;
  bool is_dearer_ = false;
  std::uint64_t rounds_ = 0;
  RoundCosts span_;           // the present one
  bool is_second_ = false;    // span of its pair
  bool is_fresh_ = false;     // the next round is the first after a change
  std::vector<Pair> pairs_;   // of this look
  Nanoseconds spent_ = 0;     // wall, in this look
  RoundCosts kept_;           // what rounds cost where they are kept, at the latest look
  RoundCosts lately_;         // ... and since
  Nanoseconds gap_ = 0;       // wall, until the next look
  Nanoseconds due_ = 0;       // wall, of it
  Nanoseconds earliest_ = 0;  // wall, if rounds come to cost something else
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_CORE_CHOICE_H
