// Decides whether a run goes faster if each participant is kept on one core, or if it has all, from
// the durations of its rounds.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_CORE_CHOICE_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_CORE_CHOICE_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "clock/scaled_clock.h"

namespace move_base_abstract {

/** @brief The user's wish. kAlternate changes every few rounds; it is for tests only. */
enum class CoresWish { kAuto, kOne, kAll, kAlternate };

/**
 * @brief The durations of rounds, by the number of granted participants: only rounds with like
 * numbers are compared.
 */
class RoundCosts {
 public:
  void add(std::size_t grants, Nanoseconds duration);
  RoundCosts& operator+=(const RoundCosts& other);

  std::uint64_t rounds() const { return rounds_; }
  Nanoseconds time() const { return time_; }
  /**
   * @return the cost of these rounds relative to @p others, for the same mixture of rounds; 0: they
   * have no kind of rounds in common.
   */
  double relativeTo(const RoundCosts& others) const;
  /**
   * @return the share of the time of these rounds, 0 to 1, that went to kinds of rounds which @p
   * others has, too.
   */
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
 * @brief Measures short spans of rounds in turn, in which each participant is kept on one core
 * ("one"; it may be the same core for all) and in which it has all cores, and keeps what is
 * faster. It measures ("looks") again later, or when the cost of rounds has changed.
 *
 * A look ends when its outcome depends on no single pair of spans. Looks cost at most a fiftieth of
 * the time, except for the first.
 */
class CoreChoice {
 public:
  explicit CoreChoice(CoresWish wish) : wish_(wish), is_one_(wish == CoresWish::kOne) {}

  /** @return whether the next round is to be on one core. */
  bool isOne() const { return is_one_; }
  /** @return whether one core is kept while no look is under way. */
  bool keepsOne() const { return keeps_one_; }
  bool isLooking() const { return is_looking_; }
  /** @return whether the look under way began because rounds cost more than before. */
  bool isDearer() const { return is_dearer_; }

  /**
   * @brief Add a round that is over.
   * @param grants the number of participants that worked in it.
   * @param duration ns, wall.
   * @param wall the present, ns.
   */
  void add(std::size_t grants, Nanoseconds duration, Nanoseconds wall);
  /** @brief Add the duration [ns, wall] of the change that add() has asked for. */
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
  bool is_second_ = false;    // whether the present span is the second of its pair
  bool is_fresh_ = false;     // the next round is the first after a change
  std::vector<Pair> pairs_;   // of this look
  Nanoseconds spent_ = 0;     // wall, in this look
  RoundCosts kept_;           // cost of rounds with the kept choice, at the latest look
  RoundCosts lately_;         // ... and since then
  Nanoseconds gap_ = 0;       // wall, until the next look
  Nanoseconds due_ = 0;       // wall, of the next look
  Nanoseconds earliest_ = 0;  // wall, of the next look if the cost of rounds changes
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_CORE_CHOICE_H
