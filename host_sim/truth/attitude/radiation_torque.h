#pragma once
// Torque of sunlight on a body's facets, each of which absorbs, mirrors and scatters its share (Wertz 1978, eq. 17-52):
//   F = -P A cos(angle) [(1 - specular) s + 2 (specular cos(angle) + diffuse / 3) n],   s to the Sun, n outwards.
// Facets do not shade each other (a convex body). Light from the Earth is neglected.

#include <memory>
#include <vector>

#include "host_sim/truth/attitude/body.h"
#include "host_sim/truth/attitude/torque.h"

namespace vbar::truth {

/// Visible fraction of the Sun. Where it jumps it has an edge, as a torque has.
class Sunlight {
 public:
  Sunlight() = default;
  Sunlight(const Sunlight&) = delete;
  Sunlight& operator=(const Sunlight&) = delete;
  virtual ~Sunlight() = default;

  /// Returns the visible fraction, 0 (eclipse) to 1 (full Sun), on the side last set.
  [[nodiscard]] virtual double fraction(const ForceInput& orbit) const = 0;

  [[nodiscard]] virtual int edge_count() const { return 0; }
  [[nodiscard]] virtual double edge(int /*index*/, const ForceInput& /*orbit*/) const { return 1.0; }
  virtual void set_side(int /*index*/, bool /*positive*/) {}
};

class RadiationTorque final : public Torque {
 public:
  /// Throws std::invalid_argument without facets or sunlight.
  RadiationTorque(std::vector<Facet> facets, std::unique_ptr<Sunlight> sunlight);

  [[nodiscard]] std::string_view name() const override { return "radiation"; }
  [[nodiscard]] fsw::Vector3 torque_body(const ForceInput& orbit, const AttitudeState& attitude) override;
  [[nodiscard]] int edge_count() const override { return sunlight_->edge_count(); }
  [[nodiscard]] double edge(int index, const ForceInput& orbit) const override { return sunlight_->edge(index, orbit); }
  void set_side(int index, bool positive) override { sunlight_->set_side(index, positive); }

 private:
  std::vector<Facet> facets_;
  std::unique_ptr<Sunlight> sunlight_;
};

}  // namespace vbar::truth
