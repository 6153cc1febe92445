#include "host_sim/truth/earth/node_polynomial.h"

namespace vbar::truth {

void fit_node_polynomial(const double (&values)[kNodePoints], double (&coefficients)[kNodePoints]) {
  // Newton's forward differences.
  double difference[kNodePoints];
  for (int i = 0; i < kNodePoints; ++i) difference[i] = values[i];
  for (int order = 1; order < kNodePoints; ++order) {
    for (int i = kNodePoints - 1; i >= order; --i) difference[i] = (difference[i] - difference[i - 1]) / order;
  }
  // Horner on the Newton form: multiply by (t - node) and add the next difference.
  for (double& c : coefficients) c = 0.0;
  for (int k = kNodePoints - 1; k >= 0; --k) {
    const double node = kFirstNode + k;
    for (int power = kNodePoints - 1; power > 0; --power) {
      coefficients[power] = coefficients[power - 1] - node * coefficients[power];
    }
    coefficients[0] = difference[k] - node * coefficients[0];
  }
}

}  // namespace vbar::truth
