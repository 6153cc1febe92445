#include "host_sim/engine/link_model.h"

#include <cmath>

#include "host_sim/engine/random_stream.h"

namespace vbar::engine {
namespace {

constexpr double kLongestLatency_s =
    9e8;  // far inside what integer nanoseconds hold, 36 means of the exponential included

bool in_order(double low, double high) {
  return 0.0 <= low && low < high && high <= kLongestLatency_s;
}

fsw::Status check_latency(const LatencyDistribution& latency) {
  for (const double value : {latency.mean_s, latency.standard_deviation_s, latency.minimum_s, latency.maximum_s})
    if (!std::isfinite(value)) return fsw::Status::kNotFinite;
  bool good = false;
  switch (latency.kind) {
    case LatencyKind::kConstant:
      good = 0.0 <= latency.mean_s && latency.mean_s <= kLongestLatency_s;
      break;
    case LatencyKind::kUniform:
      good = in_order(latency.minimum_s, latency.maximum_s);
      break;
    case LatencyKind::kNormal:
      good = in_order(latency.minimum_s, latency.maximum_s) && latency.standard_deviation_s > 0.0;
      break;
    case LatencyKind::kExponential:
      good = in_order(latency.minimum_s, latency.mean_s) && latency.mean_s <= kLongestLatency_s / 40.0;
      break;
  }
  return good ? fsw::Status::kOk : fsw::Status::kOutOfRange;
}

double latency_s(const LatencyDistribution& latency, double p) {
  switch (latency.kind) {
    case LatencyKind::kConstant:
      break;
    case LatencyKind::kUniform:
      return latency.minimum_s + (latency.maximum_s - latency.minimum_s) * p;
    case LatencyKind::kNormal: {
      const double low = (latency.minimum_s - latency.mean_s) / latency.standard_deviation_s;
      const double high = (latency.maximum_s - latency.mean_s) / latency.standard_deviation_s;
      return latency.mean_s + latency.standard_deviation_s * truncated_normal_quantile(p, low, high);
    }
    case LatencyKind::kExponential:
      return latency.minimum_s + (latency.mean_s - latency.minimum_s) * exponential_upper_quantile(p);
  }
  return latency.mean_s;
}

}  // namespace

fsw::Status check_link_settings(const LinkSettings& settings) {
  if (!std::isfinite(settings.loss_probability)) return fsw::Status::kNotFinite;
  if (settings.loss_probability < 0.0 || settings.loss_probability > 1.0) return fsw::Status::kOutOfRange;
  return check_latency(settings.latency);
}

LinkModel::LinkModel(const LinkSettings& settings, const RandomStream& stream) : settings_(settings), stream_(stream) {}

Transfer LinkModel::send(fsw::GpsTime now) {
  const auto uniforms = stream_.uniforms_of(counters_.sent++);
  Transfer transfer;
  transfer.lost = uniforms[0] < settings_.loss_probability;
  transfer.delivery = now + fsw::nearest_duration(latency_s(settings_.latency, uniforms[1]));
  if (transfer.lost) ++counters_.lost;
  return transfer;
}

}  // namespace vbar::engine
