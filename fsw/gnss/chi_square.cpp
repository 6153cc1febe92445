#include "fsw/gnss/chi_square.h"

#include "fsw/math/math.h"

namespace vbar::fsw::gnss {

double chi_square_tail(double x, std::size_t degrees) {
  const double half = 0.5 * x;
  const bool odd = degrees % 2 == 1;
  // Terms half^s / Gamma(s + 1) exp(-half), s from 0 or 1/2 in steps of 1 while below degrees / 2.
  constexpr double kTwoOverSqrtPi = 1.12837916709551257390;
  double power = odd ? 0.5 : 0.0;
  double term = math::exp(-half) * (odd ? kTwoOverSqrtPi * math::sqrt(half) : 1.0);
  double tail = odd ? math::erfc(math::sqrt(half)) : 0.0;
  for (std::size_t k = odd ? 3 : 2; k <= degrees; k += 2) {
    tail += term;
    power += 1.0;
    term *= half / power;
  }
  return tail;
}

}  // namespace vbar::fsw::gnss
