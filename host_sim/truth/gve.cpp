#include "host_sim/truth/gve.h"

namespace vbar::truth {

fsw::Vector6 vector_from_elements(const fsw::orbit::QnsElements& q) {
  fsw::Vector6 vector;
  vector << q.a, q.ex, q.ey, q.i, q.raan, q.u;
  return vector;
}

fsw::orbit::QnsElements elements_from_vector(const fsw::Vector6& vector) {
  return {vector[0], vector[1], vector[2], vector[3], vector[4], vector[5]};
}

fsw::Vector6 gve_rates(const fsw::orbit::QnsElements& q, const OrbitGeometry& g, const fsw::Vector3& perturbation_rtn) {
  const double f_r = perturbation_rtn.x(), f_t = perturbation_rtn.y(), f_n = perturbation_rtn.z();
  const double c = g.cos_theta, s = g.sin_theta;
  const double e_cos = q.ex * c + q.ey * s;  // e cos(true anomaly)
  const double e_sin = q.ex * s - q.ey * c;  // e sin(true anomaly)
  const double per_h = 1.0 / g.h;
  const double node_rate = g.r * s * per_h / g.sin_i * f_n;
  const double node_turn = node_rate * g.cos_i;  // the node's motion seen in the orbital plane

  fsw::Vector6 rates;
  rates[0] = 2.0 * q.a * q.a * per_h * (e_sin * f_r + (1.0 + e_cos) * f_t);
  rates[1] = per_h * (g.p * s * f_r + ((g.p + g.r) * c + g.r * q.ex) * f_t) + q.ey * node_turn;
  rates[2] = per_h * (-g.p * c * f_r + ((g.p + g.r) * s + g.r * q.ey) * f_t) - q.ex * node_turn;
  rates[3] = g.r * c * per_h * f_n;
  rates[4] = node_rate;
  rates[5] =
      g.n - node_turn +
      per_h * (-(g.p * e_cos / (1.0 + g.eta) + 2.0 * g.eta * g.r) * f_r + (g.p + g.r) * e_sin / (1.0 + g.eta) * f_t);
  return rates;
}

}  // namespace vbar::truth
