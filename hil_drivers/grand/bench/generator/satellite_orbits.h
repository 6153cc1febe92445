#pragma once
// True motion and clock of the satellites as polynomials over 16 s, which several vehicles share: a hundred times
// cheaper than the elements themselves, and within 1e-6 m of them (verified by its test).

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/truth/earth/node_polynomial.h"
#include "host_sim/twins/gnss/constellation.h"

namespace vbar::grand::bench {

/// Motion in the Earth-fixed frame of the same instant; derivatives relative to that rotating frame.
struct SatelliteMotion {
  fsw::Vector3 position = fsw::Vector3::Zero();
  fsw::Vector3 velocity = fsw::Vector3::Zero();
  fsw::Vector3 acceleration = fsw::Vector3::Zero();
  double clock_m = 0.0;  ///< satellite clock minus GPS time, times c
  double clock_rate_mps = 0.0;
};

class SatelliteOrbits {
 public:
  /// `start` is the origin of the times below.
  SatelliteOrbits(std::shared_ptr<const twins::gnss::Constellation> constellation, fsw::GpsTime start);

  [[nodiscard]] std::size_t size() const { return constellation_->size(); }
  [[nodiscard]] const twins::gnss::Constellation& constellation() const { return *constellation_; }
  [[nodiscard]] fsw::GpsTime start() const { return start_; }

  /// Returns the motion at `time_s` since start, which may be negative. A pure function of its arguments.
  [[nodiscard]] SatelliteMotion at(std::size_t index, double time_s);

 private:
  static constexpr double kInterval_s = 16.0;
  static constexpr std::size_t kQuantities = 4;  ///< x, y, z, clock
  static constexpr std::int64_t kNever = INT64_MIN;

  using Node = std::array<double, kQuantities>;
  struct Piece {
    std::int64_t interval = kNever;
    double coefficients[kQuantities][truth::kNodePoints] = {};
  };
  /// Polynomials in use. Vehicles are moved at slightly different times, so that two neighbouring intervals are in use
  /// at once.
  struct Satellite {
    std::array<Piece, 2> pieces;  ///< by the parity of the interval
    std::array<Node, 8> nodes{};  ///< by the lowest bits of the node's number
    std::array<std::int64_t, 8> node_numbers = empty_numbers();
  };
  static constexpr std::array<std::int64_t, 8> empty_numbers() {
    return {kNever, kNever, kNever, kNever, kNever, kNever, kNever, kNever};
  }

  const Piece& piece(std::size_t index, std::int64_t interval);
  const Node& node(std::size_t index, std::int64_t number);

  std::shared_ptr<const twins::gnss::Constellation> constellation_;
  fsw::GpsTime start_;
  std::vector<Satellite> satellites_;
};

}  // namespace vbar::grand::bench
