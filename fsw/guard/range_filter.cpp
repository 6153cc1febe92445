#include "fsw/guard/range_filter.h"

#include "fsw/math/math.h"

namespace vbar::fsw::guard {

void RangeFilter::add(GpsTime time, double range_m) {
  if (!(range_m > 0.0) || (samples_ > 0 && time <= last_)) return;
  const double gap_s = seconds(time - last_);
  const double logarithm = math::log(range_m);
  if (samples_ == 0 || gap_s > kLongestGap_s) {
    *this = RangeFilter();
    first_ = last_ = time;
    samples_ = 1;
    logarithm_ = logarithm;
    return;
  }
  // The gains are those of a filter with this memory in steady state; the first samples are averaged.
  const double steady = 2.0 * gap_s / kMemory_s;
  const double averaging = 1.0 / static_cast<double>(samples_ + 1);
  const double larger = steady > averaging ? steady : averaging;
  const double alpha = larger < 1.0 ? larger : 1.0;
  const double fading = gap_s / kMemory_s;
  const double beta = fading * fading < 1.0 ? fading * fading : 1.0;
  const double predicted = logarithm_ + rate_ * gap_s;
  const double residual = logarithm - predicted;
  logarithm_ = predicted + alpha * residual;
  rate_ += beta / gap_s * residual;
  last_ = time;
  ++samples_;
}

double RangeFilter::range_m(GpsTime time) const {
  return is_known() ? math::exp(logarithm_ + rate_ * seconds(time - last_)) : 0.0;
}

}  // namespace vbar::fsw::guard
