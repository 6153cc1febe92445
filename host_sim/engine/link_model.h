#pragma once
// A simulated link: latency and loss of each packet. (Faults of the real line to a flight
// computer are corrected by the step barrier and do not occur here.)

#include <cstdint>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::engine {

enum class LatencyKind { kConstant, kUniform, kNormal, kExponential };

/// Distribution of the latency, s. The fields that are used depend on the kind.
struct LatencyDistribution {
  LatencyKind kind = LatencyKind::kConstant;
  double mean_s = 0.0;  ///< constant: the value; normal: before truncation; exponential: mean, the minimum included
  double standard_deviation_s = 0.0;  ///< normal, before truncation
  double minimum_s = 0.0;             ///< uniform, normal (cut off there), exponential (shifted by it)
  double maximum_s = 0.0;             ///< uniform, normal (cut off there)
  friend bool operator==(const LatencyDistribution&, const LatencyDistribution&) = default;
};

struct LinkSettings {
  LatencyDistribution latency;
  double loss_probability = 0.0;  ///< 0 to 1, independent from packet to packet
  friend bool operator==(const LinkSettings&, const LinkSettings&) = default;
};

/// Result of the transmission of one packet.
struct Transfer {
  bool lost = false;
  fsw::GpsTime delivery;  ///< when it arrives; when it would have, if lost
};

struct LinkCounters {
  std::uint64_t sent = 0;
  std::uint64_t lost = 0;
};

/// kNotFinite, kOutOfRange (negative times, empty intervals, a mean below the minimum, latencies above 9e8 s, an
/// invalid probability).
fsw::Status check_link_settings(const LinkSettings& settings);

class LinkModel {
 public:
  /// `settings` must pass check_link_settings. The stream should be the link's own.
  LinkModel(const LinkSettings& settings, const RandomStream& stream);

  /// Sends the next packet. Its draws belong to its number: loss does not depend on the latency distribution, nor a
  /// packet's latency on the loss of others. Packets may overtake one another.
  Transfer send(fsw::GpsTime now);

  [[nodiscard]] const LinkCounters& counters() const { return counters_; }

 private:
  LinkSettings settings_;
  RandomStream stream_;
  LinkCounters counters_;
};

}  // namespace vbar::engine
