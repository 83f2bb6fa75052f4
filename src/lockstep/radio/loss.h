// The probability that a message is lost on its way.
#pragma once

#include <utility>
#include <variant>
#include <vector>

namespace move_base_abstract::radio {

/**
 * @brief Distances [m], ascending, with the probabilities there: linear between them, constant
 * outside.
 */
using LossTable = std::vector<std::pair<double, double>>;

/**
 * @brief Log-distance path loss with log-normal shadowing (T. S. Rappaport, Wireless
 * Communications, 2nd ed., 4.9, equation 4.69): the received power is power - loss_at_reference -
 * 10 exponent log10(d / reference) dBm on average, less what walls cost, with a normal distribution
 * about that. A message is lost if it is below the sensitivity.
 */
struct PathLoss {
  double power;              // dBm, sent
  double sensitivity;        // dBm
  double exponent;           // 2 in free space
  double reference;          // m
  double loss_at_reference;  // dB
  double shadowing;          // dB, the standard deviation, drawn per message; 0: none
};

using Loss = std::variant<double, LossTable, PathLoss>;

/**
 * @return the probability [0, 1] at @p distance [m], behind walls that cost @p walls [dB]. Only a
 * path loss uses @p walls.
 */
double lossAt(const Loss& loss, double distance, double walls);

// The functions below use only + - * / and the split of a number into digits and exponent, which
// IEEE 754 defines to the last bit. The log and erf of different libraries differ in the last bit.
// The compiler must not contract these operations (CMakeLists.txt).

/** @return the decimal logarithm of @p value > 0, to a few units in the last place. */
double decimalLogarithm(double value);
/**
 * @return the probability that a normal variable of mean 0 and variance 1 is below @p value. The
 * result is exact to 1e-10 from -5 to 5. Beyond that it is 0 or 1, which is wrong by less than
 * 3e-7.
 */
double normalBelow(double value);

}  // namespace move_base_abstract::radio
