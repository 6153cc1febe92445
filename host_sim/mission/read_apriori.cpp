#include "host_sim/mission/read_apriori.h"

namespace vbar::mission {

fsw::Vector6 read_apriori(const TableReader& section, const fsw::Vector6& usual) {
  section.accept_only({"sigma_a_da_m", "sigma_a_dlambda_m", "sigma_a_de_m", "sigma_a_di_m"});
  const Range sigma = above_to(0.0, 1e5);
  const double a = section.number("sigma_a_da_m", sigma, usual(0));
  const double lambda = section.number("sigma_a_dlambda_m", sigma, usual(1));
  const double e = section.number("sigma_a_de_m", sigma, usual(2));
  const double i = section.number("sigma_a_di_m", sigma, usual(4));
  return {a, lambda, e, e, i, i};
}

}  // namespace vbar::mission
