#pragma once
// Digital twin of a laser range finder: the distance from the servicer's centre of mass to the target's, with a bias
// drawn once in a run and noise of each measurement. The shape of the target and the place of the instrument on the
// servicer are not modelled.

#include <cstdint>
#include <optional>
#include <string>

#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/packet_encoder.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::sensors {

struct RangeFinderSettings {
  double range_min_m = 0.5, range_max_m = 1000.0;  ///< beyond them nothing is measured
  double bias_sigma_m = 0.0, noise_sigma_m = 0.0;
  double half_angle_rad = 0.0;                          ///< half angle of the cone of the field of view
  fsw::Vector3 boresight_body = fsw::Vector3::UnitZ();  ///< unit vector
  fsw::Duration period;                                 ///< > 0
};

/// Place of the target as the instrument sees it.
struct LineOfSight {
  double range_m = 0.0;
  double off_boresight_rad = 0.0;
};

/// Returns the line of sight to the target; none if the truth lacks a spacecraft or the servicer's attitude.
[[nodiscard]] std::optional<LineOfSight> line_of_sight(const twins::TruthSnapshot& truth, const std::string& servicer,
                                                       const std::string& target, const fsw::Vector3& boresight_body);

/// Whether the target is inside the field of view and the limits of the range, these included. Both are of the centre
/// of mass.
[[nodiscard]] bool is_measurable(const LineOfSight& sight, const RangeFinderSettings& settings);

class RangeFinder final : public twins::PacketSource {
 public:
  struct Place {
    std::string servicer, target;
    std::uint8_t flight_number = 0, unit = 0;
    fsw::GpsTime start;  ///< first epoch
  };

  /// Makes a range finder; `stream` is that of its errors.
  RangeFinder(const RangeFinderSettings& settings, const Place& place, const engine::RandomStream& stream);

  [[nodiscard]] std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override;

  /// Measures one range_measurement packet; none if the target is not measurable. kFailed without the truth it needs.
  twins::Measurement measure(const twins::TruthSnapshot& truth) override;

  [[nodiscard]] bool truth_is_compared() const override { return true; }

 private:
  /// Returns the noise of an epoch, which does not depend on earlier measurements.
  [[nodiscard]] double noise_m(fsw::GpsTime time) const;

  RangeFinderSettings settings_;
  Place place_;
  engine::RandomStream stream_;
  double bias_m_;
  twins::PacketEncoder encoder_;
};

}  // namespace vbar::sensors
