#include "loss.h"

#include <cmath>

namespace move_base_abstract::radio {
namespace {

constexpr double kLn2 = 0.693147180559945309417;
constexpr double kInverseLn10 = 0.434294481903251827651;
constexpr double kRootOfHalf = 0.707106781186547524401;
constexpr double kInverseRootOf2Pi = 0.398942280401432677940;
constexpr double kFarOut = 5.0;

double at(const LossTable& table, double distance) {
  if (distance <= table.front().first) {
    return table.front().second;
  }
  for (std::size_t index = 1; index < table.size(); ++index) {
    const auto& [before, low] = table[index - 1];
    const auto& [here, high] = table[index];
    if (distance < here) {
      return low + (high - low) * ((distance - before) / (here - before));
    }
  }
  return table.back().second;
}

double at(const PathLoss& law, double distance, double walls) {
  const double ratio = (distance > law.reference ? distance : law.reference) / law.reference;
  const double mean =
      law.power - law.loss_at_reference - 10.0 * law.exponent * decimalLogarithm(ratio) - walls;
  if (law.shadowing == 0.0) {
    return mean < law.sensitivity ? 1.0 : 0.0;
  }
  return normalBelow((law.sensitivity - mean) / law.shadowing);
}

}  // namespace

double decimalLogarithm(double value) {
  int exponent = 0;
  double digits = std::frexp(value, &exponent);  // from 0.5 to 1: exact
  if (digits < kRootOfHalf) {
    digits *= 2.0;
    --exponent;
  }
  // ln x = 2 artanh((x - 1) / (x + 1)), of which each term is less than 0.03 of the one before.
  const double ratio = (digits - 1.0) / (digits + 1.0);
  const double square = ratio * ratio;
  double sum = 0.0;
  for (int odd = 25; odd >= 1; odd -= 2) {
    sum = sum * square + 1.0 / odd;
  }
  return (exponent * kLn2 + 2.0 * ratio * sum) * kInverseLn10;
}

double normalBelow(double value) {
  if (!(value > -kFarOut)) {
    return 0.0;
  }
  if (value >= kFarOut) {
    return 1.0;
  }
  // The integral of exp(-t^2 / 2), term by term.
  double power = value;  // (-1)^k value^(2k + 1) / (2^k k!)
  double sum = value;
  for (int k = 1; k < 80; ++k) {
    power *= -value * value / (2.0 * k);
    sum += power / (2.0 * k + 1.0);
  }
  return 0.5 + kInverseRootOf2Pi * sum;
}

double lossAt(const Loss& loss, double distance, double walls) {
  if (const auto* law = std::get_if<PathLoss>(&loss)) {
    return at(*law, distance, walls);
  }
  if (const auto* table = std::get_if<LossTable>(&loss)) {
    return at(*table, distance);
  }
  return std::get<double>(loss);
}

}  // namespace move_base_abstract::radio
