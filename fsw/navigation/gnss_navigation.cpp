#include "fsw/navigation/gnss_navigation.h"

#include <Eigen/Geometry>

#include "fsw/math/math.h"
#include "fsw/navigation/single_point.h"
#include "fsw/orbit/constants.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::navigation {
namespace {

constexpr std::size_t index_of(Receiver receiver) {
  return static_cast<std::size_t>(receiver);
}

// Differences of single-point solutions cancel the errors of orbits and clocks, but not the noise.
constexpr double kStartSigma_m = 5.0;
// A relative state contradicted by most codes in this number of epochs is considered lost.
constexpr int kMaxContradicted = 5;
// The sigma of a single-point solution excludes slow errors common to all epochs.
constexpr double kOrbitSigma_m = 2.0;

}  // namespace

GnssNavigation::GnssNavigation(const GnssNavigationSettings& settings)
    : settings_(settings), relative_(settings.relative) {}

void GnssNavigation::configure(const GnssNavigationSettings& settings) {
  settings_ = settings;
  orbit_.reset();
  relative_.configure(settings.relative);
  ambiguities_.reset();
  has_epoch_ = false;
  relative_has_begun_ = false;
  contradicted_in_a_row_ = 0;
}

void GnssNavigation::take(Receiver receiver, const gnss::ObservationEpoch& epoch) {
  const bool is_late = has_epoch_ && epoch.receiver_time <= epoch_;
  if (is_late || waiting_[index_of(receiver)].file(epoch) != Status::kOk) ++counters_.too_late;
}

void GnssNavigation::take(const gnss::Ephemeris& ephemeris) {
  // A refused set is invalid or unsupported: no information is lost.
  static_cast<void>(ephemerides_.put(ephemeris));
}

void GnssNavigation::take(Receiver receiver, const AttitudeSample& attitude) {
  attitudes_[index_of(receiver)].put(attitude);
}

void GnssNavigation::update(GpsTime now, std::span<const Burn> burns) {
  EpochBuffer& ours = waiting_[index_of(Receiver::kServicer)];
  EpochBuffer& theirs = waiting_[index_of(Receiver::kTarget)];
  for (std::size_t k = 0; k < EpochBuffer::kEpochs; ++k) {
    const gnss::ObservationEpoch* epoch = ours.oldest();
    if (epoch == nullptr || epoch->receiver_time > now) break;
    const GpsTime tag = epoch->receiver_time;
    const gnss::ObservationEpoch* other = theirs.find(tag);
    if (other == nullptr && now - tag <= settings_.pair_wait) break;
    take_epoch(*epoch, other, burns);
    ours.drop_through(tag);
    theirs.drop_through(tag);
  }
}

/// The servicer's orbit from its own receiver, and, if the target's epoch of that tag is available, the relative orbit.
void GnssNavigation::take_epoch(const gnss::ObservationEpoch& epoch, const gnss::ObservationEpoch* other,
                                std::span<const Burn> burns) {
  const EarthFrame frame = EarthFrame::at(epoch.receiver_time, settings_.earth);
  const Result<SinglePoint> point = single_point(epoch, ephemerides_, frame);
  if (!point.ok()) {
    ++counters_.no_solution;
    return;
  }
  advance_to(epoch.receiver_time, burns);
  epoch_ = epoch.receiver_time;
  has_epoch_ = true;
  // The position is that at the instant of reception, the tag that of the receiver clock.
  const double early_s = point.value().clock_m / gnss::kSpeedOfLight;
  const double sigma_m = math::hypot(point.value().sigma_m, kOrbitSigma_m);
  orbit_.take_position(epoch.receiver_time, early_s, point.value().position_eci, sigma_m);
  if (other == nullptr) {
    ++counters_.alone;
    return;
  }
  if (orbit_.started()) take_pair(epoch, *other, point.value().clock_m, frame);
}

/// Both filters to `time`, including the burns until then: a burn at `time` comes after it.
void GnssNavigation::advance_to(GpsTime time, std::span<const Burn> burns) {
  if (!has_epoch_ || !orbit_.started()) return;
  for (const Burn& burn : burns) {
    if (burn.time < epoch_ || burn.time >= time) continue;
    relative_.advance_to(burn.time, orbit_.state());
    orbit_.advance_to(burn.time);
    if (!orbit_.started()) return;
    const Vector3 dv_eci = orbit::R_rtn_eci(orbit_.state()).transpose() * burn.dv_rtn;
    orbit_.add_impulse(dv_eci);
    relative_.add_servicer_impulse(dv_eci);
  }
  relative_.advance_to(time, orbit_.state());
  orbit_.advance_to(time);
}

void GnssNavigation::take_pair(const gnss::ObservationEpoch& ours, const gnss::ObservationEpoch& theirs,
                               double servicer_clock_m, const EarthFrame& frame) {
  const GpsTime tag = ours.receiver_time;
  const Result<SinglePoint> their_point = single_point(theirs, ephemerides_, frame);
  const auto our_attitude = attitudes_[index_of(Receiver::kServicer)].R_eci_body_at(tag);
  const auto their_attitude = attitudes_[index_of(Receiver::kTarget)].R_eci_body_at(tag);
  if (!their_point.ok() || !our_attitude || !their_attitude) {
    ++counters_.no_solution;
    return;
  }
  ReceiverPlatform servicer;
  servicer.state = orbit_.state();
  servicer.R_eci_body = *our_attitude;
  servicer.antenna_body_m = settings_.servicer_antenna_body_m;
  servicer.clock_m = servicer_clock_m;
  ReceiverPlatform target;
  target.R_eci_body = *their_attitude;
  target.antenna_body_m = settings_.target_antenna_body_m;
  target.clock_m = their_point.value().clock_m;
  if (!relative_.started()) {
    if (relative_has_begun_) ++counters_.restarts;
    const double their_late = target.clock_m / gnss::kSpeedOfLight;
    const Vector3 position =
        their_point.value().position_eci + their_late * servicer.state.velocity_eci - servicer.state.position_eci;
    const double radius = servicer.state.position_eci.norm();
    relative_.begin(tag, position, math::hypot(kStartSigma_m, their_point.value().sigma_m),
                    math::sqrt(orbit::kMu / (radius * radius * radius)));
    relative_has_begun_ = true;
    ambiguities_.reset();
  }
  form_differences(ours, theirs, ephemerides_, frame, differences_);
  last_update_ = relative_.take(differences_, servicer, target);
  contradicted_in_a_row_ = last_update_.codes_refused > last_update_.codes_used ? contradicted_in_a_row_ + 1 : 0;
  if (contradicted_in_a_row_ == kMaxContradicted) {
    relative_.reset();
    contradicted_in_a_row_ = 0;
  }
  ambiguities_.update(relative_, last_update_, settings_.ambiguities);
  ++counters_.pairs;
  last_pair_ = tag;
  counters_.codes_refused += last_update_.codes_refused;
  counters_.phases_refused += last_update_.phases_refused;
  counters_.slips += last_update_.slips;
}

orbit::CartesianState GnssNavigation::target() const {
  const orbit::CartesianState ours = servicer();
  return {.position_eci = ours.position_eci + relative_.position_eci(),
          .velocity_eci = ours.velocity_eci + relative_.velocity_eci()};
}

Matrix6 GnssNavigation::covariance_rtn() const {
  const orbit::CartesianState ours = servicer();
  const Matrix3 R_rtn = orbit::R_rtn_eci(ours);
  const Vector3 momentum = ours.position_eci.cross(ours.velocity_eci);
  const double rate = momentum.norm() / ours.position_eci.squaredNorm();
  Matrix3 rate_cross;  // w x, about N
  rate_cross << 0.0, -rate, 0.0, rate, 0.0, 0.0, 0.0, 0.0, 0.0;
  Matrix6 map = Matrix6::Zero();
  map.topLeftCorner<3, 3>() = R_rtn;
  map.bottomRightCorner<3, 3>() = R_rtn;
  map.bottomLeftCorner<3, 3>() = -(rate_cross * R_rtn);
  const Matrix6 half = map.lazyProduct(relative_.estimate().head_covariance<6>());
  return half.lazyProduct(map.transpose());
}

}  // namespace vbar::fsw::navigation
