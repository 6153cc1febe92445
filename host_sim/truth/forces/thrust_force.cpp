#include "host_sim/truth/forces/thrust_force.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "fsw/orbit/rtn.h"

namespace vbar::truth {
namespace {

constexpr std::size_t kKeptArcs = 16;

std::array<double, 4> corners_of(const ThrustArc& arc) {
  return {arc.begin_s, arc.begin_s + arc.rise_s, arc.begin_s + arc.rise_s + arc.hold_s, arc.end_s()};
}

}  // namespace

double ThrustArc::force_n(double seconds) const {
  const auto [begin, full, closing, end] = corners_of(*this);
  if (seconds < begin || seconds > end) return 0.0;
  if (seconds < full) return peak_n * (seconds - begin) / rise_s;
  if (seconds <= closing) return peak_n;
  return peak_n * (end - seconds) / fall_s;
}

double ThrustArc::impulse_ns(double seconds) const {
  const double in_rise_s = std::clamp(seconds - begin_s, 0.0, rise_s);
  const double in_hold_s = std::clamp(seconds - begin_s - rise_s, 0.0, hold_s);
  const double in_fall_s = std::clamp(seconds - begin_s - rise_s - hold_s, 0.0, fall_s);
  double impulse = peak_n * in_hold_s;
  if (rise_s > 0.0) impulse += 0.5 * peak_n * in_rise_s * in_rise_s / rise_s;
  if (fall_s > 0.0) impulse += peak_n * in_fall_s * (1.0 - 0.5 * in_fall_s / fall_s);
  return impulse;
}

double ThrustArc::mass_at_kg(double seconds) const {
  return mass_kg - impulse_ns(seconds) / exhaust_velocity_mps;
}

void ThrustForce::add(const ThrustArc& arc) {
  if (!arcs_.empty() && arc.begin_s < arcs_.back().end_s())
    throw std::invalid_argument("a burn begins before the last one has ended");
  arcs_.push_back(arc);
  if (arcs_.size() > kKeptArcs) arcs_.pop_front();
}

fsw::Vector3 ThrustForce::acceleration_eci(const ForceInput& input) {
  if (acting_ == nullptr) return fsw::Vector3::Zero();
  // Just outside its burn, within rounding of an edge, the force is that of the edge.
  const double seconds = std::clamp(input.seconds, acting_->begin_s, acting_->end_s());
  const fsw::Matrix3 R_rtn_eci = fsw::orbit::R_rtn_eci({input.position_eci, input.velocity_eci});
  return acting_->force_n(seconds) / acting_->mass_at_kg(seconds) * R_rtn_eci.transpose() * acting_->direction_rtn;
}

double ThrustForce::next_jump_after(double seconds) const {
  double next = Force::next_jump_after(seconds);
  for (const ThrustArc& arc : arcs_)
    for (const double corner : corners_of(arc))
      if (corner > seconds) next = std::min(next, corner);
  return next;
}

void ThrustForce::enter_interval(double seconds) {
  const auto acting = std::ranges::find_if(
      arcs_, [seconds](const ThrustArc& arc) { return seconds >= arc.begin_s && seconds < arc.end_s(); });
  acting_ = acting == arcs_.end() ? nullptr : &*acting;
}

}  // namespace vbar::truth
