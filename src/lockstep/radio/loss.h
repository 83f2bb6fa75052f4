// How probable it is that a message is lost on its way.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_LOSS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_LOSS_H

#include <utility>
#include <variant>
#include <vector>

namespace move_base_abstract::radio {

/** @brief Distances [m], ascending, and the probabilities there; straight between, level outside.
 */
using LossTable = std::vector<std::pair<double, double>>;

/**
 * @brief Log-distance path loss with log-normal shadowing (T. S. Rappaport, Wireless
 * Communications, 2nd ed., 4.9, equation 4.69): what arrives has power - loss_at_reference -
 * 10 exponent log10(d / reference) dBm on average, less what walls cost, and is spread about that
 * as a normal distribution; it is lost below the sensitivity.
 */
struct PathLoss {
  double power;              // dBm, sent
  double sensitivity;        // dBm
  double exponent;           // 2 in free space
  double reference;          // m
  double loss_at_reference;  // dB
  double shadowing;          // dB, the standard deviation, of each message anew; 0: none
};

using Loss = std::variant<double, LossTable, PathLoss>;

/** @return the probability [0, 1] at @p distance [m] behind walls that cost @p walls [dB], which
 * only a path loss looks at. */
double lossAt(const Loss& loss, double distance, double walls);

// Made of + - * / and of splitting a number into its digits and its exponent, which IEEE 754 gives
// to the last bit: libraries' log and erf differ in it. Not to be contracted (CMakeLists.txt).

/** @return the decimal logarithm of @p value > 0, to some units of its last place. */
double decimalLogarithm(double value);
/** @return the probability that a normal variable of mean 0 and variance 1 is below @p value. To
 * 1e-10 within 5 of 0; 0 or 1 beyond, where it is less than 3e-7 away from that. */
double normalBelow(double value);

}  // namespace move_base_abstract::radio

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_LOSS_H
