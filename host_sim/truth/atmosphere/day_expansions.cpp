#include "host_sim/truth/atmosphere/day_expansions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

namespace vbar::truth {

namespace {

constexpr double kQuietAp = 4.0;
constexpr double kThreeHours = 10800.0;

/// From slope 1 at the quiet value to `slope` far above, with rate `rate`.
double saturated(double ap, double rate, double slope) {
  const double excess = ap - kQuietAp;
  return excess + (slope - 1.0) * (excess + (std::exp(-rate * excess) - 1.0) / rate);
}

}  // namespace

EffectiveAp::EffectiveAp(const Nrlmsise00Tables::Upper& p, const SolarIndices& indices) {
  if (indices.geomagnetic_index == GeomagneticIndex::kDaily) {
    daily_ = saturated(indices.ap_daily, p[43], p[44]);
    return;
  }
  if (p[51] == 0.0) return;  // the quantity does not respond
  remembers_ = true;
  for (std::size_t i = 0; i < history_.size(); ++i) history_[i] = saturated(indices.ap_history[i], p[24], p[25]);
  fading_ = kThreeHours * std::abs(p[51]);
  latitude_slope_ = p[138];
}

double EffectiveAp::at(double latitude_deg) const {
  if (!remembers_) return daily_;
  constexpr double kMaxDecay = 0.99999;  // the sums below divide by 1 - e
  const double e = std::min(std::exp(-fading_ / (1.0 + latitude_slope_ * (45.0 - std::abs(latitude_deg)))), kMaxDecay);
  // Weights e^k of the k-th three hours before; a mean of eight replaces eight neighbouring powers.
  const double e2 = e * e, e3 = e2 * e, e4 = e2 * e2, e8 = e4 * e4, e12 = e8 * e4;
  const double eight = (1.0 - e8) / (1.0 - e);
  const double sum = history_[0] + history_[1] * e + history_[2] * e2 + history_[3] * e3 +
                     (history_[4] * e4 + history_[5] * e12) * eight;
  const double e19 = e12 * e4 * e3;
  return sum / (1.0 + (1.0 - e19) / (1.0 - e) * std::sqrt(e));
}

namespace {

constexpr std::size_t kBoundaryTemperature = 5;  // its place in upper_quantities()

using Upper = Nrlmsise00Tables::Upper;
using Lower = Nrlmsise00Tables::Lower;

std::array<std::reference_wrapper<const Upper>, 11> upper_quantities(const Nrlmsise00Tables& t) {
  return {t.pt, t.ps, t.pd[0], t.pd[1], t.pd[2], t.pd[3], t.pd[4], t.pd[5], t.pd[6], t.pd[7], t.pd[8]};
}

std::array<std::reference_wrapper<const Lower>, 5> lower_thermosphere_quantities(const Nrlmsise00Tables& t) {
  return {t.ptl[0], t.ptl[1], t.ptl[2], t.ptl[3], t.pma[8]};
}

std::array<std::reference_wrapper<const Lower>, 9> lower_atmosphere_quantities(const Nrlmsise00Tables& t) {
  return {t.pma[0], t.pma[1], t.pma[2], t.pma[3], t.pma[4], t.pma[5], t.pma[6], t.pma[7], t.pma[9]};
}

void add(HorizontalSeries& sum, double factor, const HorizontalSeries& term) {
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += factor * term[k];
}

}  // namespace

void DayExpansions::set_day(int day_of_year, const SolarIndices& indices) {
  if (day_of_year == day_of_year_ && indices == indices_) return;
  day_of_year_ = day_of_year;
  indices_ = indices;
  work_out();
}

void DayExpansions::work_out() {
  constexpr double kAnyLatitudeDeg = 0.0;  // for the daily index, which all latitudes share
  remembers_ = indices_.geomagnetic_index == GeomagneticIndex::kThreeHourly;

  const auto upper = upper_quantities(*tables_);
  for (std::size_t i = 0; i < upper.size(); ++i) {
    effective_ap_[i] = EffectiveAp(upper[i], indices_);
    ExpansionOfDay expansion = upper_expansion(upper[i], day_of_year_, indices_);
    if (!remembers_) add(expansion.quiet, effective_ap_[i].at(kAnyLatitudeDeg), expansion.magnetic);
    upper_.set(static_cast<int>(i), expansion.quiet);
    upper_magnetic_.set(static_cast<int>(i), expansion.magnetic);
  }

  const auto lower = lower_thermosphere_quantities(*tables_);
  for (std::size_t i = 0; i < lower.size(); ++i) {
    // The lower thermosphere responds to activity as the temperature at its upper boundary does.
    ExpansionOfDay expansion = lower_expansion(lower[i], day_of_year_, indices_);
    if (!remembers_) add(expansion.quiet, effective_ap_[kBoundaryTemperature].at(kAnyLatitudeDeg), expansion.magnetic);
    lower_thermosphere_.set(static_cast<int>(i), expansion.quiet);
    lower_thermosphere_magnetic_.set(static_cast<int>(i), expansion.magnetic);
  }
  lower_atmosphere_ready_ = false;
  turbopause_season_ = std::cos(kModelDay * (day_of_year_ - tables_->pt[13]));
}

UpperVariations DayExpansions::upper(const HorizontalSeries& functions, double latitude_deg) const {
  auto v = upper_.sums(functions);
  if (remembers_) {
    const auto magnetic = upper_magnetic_.sums(functions);
    for (std::size_t i = 0; i < v.size(); ++i) v[i] += effective_ap_[i].at(latitude_deg) * magnetic[i];
  }
  return {.exospheric_temperature = v[0],
          .gradient = v[1],
          .boundary_temperature = v[kBoundaryTemperature],
          .he = v[2],
          .o = v[3],
          .n2 = v[4],
          .o2 = v[6],
          .ar = v[7],
          .h = v[8],
          .n = v[9],
          .anomalous_o = v[10]};
}

LowerThermosphereVariations DayExpansions::lower_thermosphere(const HorizontalSeries& functions,
                                                              double latitude_deg) const {
  auto v = lower_thermosphere_.sums(functions);
  if (remembers_) {
    const auto magnetic = lower_thermosphere_magnetic_.sums(functions);
    const double activity = effective_ap_[kBoundaryTemperature].at(latitude_deg);
    for (std::size_t i = 0; i < v.size(); ++i) v[i] += activity * magnetic[i];
  }
  return {.temperature = {v[0], v[1], v[2], v[3]}, .bottom_gradient = v[4]};
}

LowerAtmosphereVariations DayExpansions::lower_atmosphere(const HorizontalSeries& functions) {
  if (!lower_atmosphere_ready_) {
    const auto quantities = lower_atmosphere_quantities(*tables_);
    for (std::size_t i = 0; i < quantities.size(); ++i) {
      // The published coefficients have no response to geomagnetic activity below 72.5 km.
      lower_atmosphere_.set(static_cast<int>(i), lower_expansion(quantities[i], day_of_year_, indices_).quiet);
    }
    lower_atmosphere_ready_ = true;
  }
  const auto v = lower_atmosphere_.sums(functions);
  return {.stratosphere = {v[0], v[1], v[2]},
          .troposphere = {v[3], v[4], v[5], v[6]},
          .surface_gradient = v[7],
          .joint_gradient = v[8]};
}

}  // namespace vbar::truth
