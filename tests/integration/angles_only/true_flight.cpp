#include "tests/integration/angles_only/true_flight.h"

#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <Eigen/LU>

#include "fsw/filter/propagation.h"
#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/truth_model.h"
#include "tests/support/paths.h"

namespace vbar::test {

namespace {

using fsw::Vector2;
using fsw::Vector3;
using fsw::Vector6;
namespace orbit = fsw::orbit;

constexpr double kDegree = fsw::math::kDegree;
constexpr double kArcsec = kDegree / 3600.0;
constexpr double kImagePeriod_s = 60.0;
constexpr double kGnssPeriod_s = 10.0;
constexpr double kGnssSlow_s = 1800.0;

template <class T>
T must(const fsw::Result<T>& result) {
  if (!result.ok()) throw std::runtime_error("no orbit");
  return result.value();
}

std::vector<fsw::filter::Burn> load_burns(fsw::GpsTime start) {
  std::ifstream file(vbar::tests::source_path("tests/integration/angles_only/burns.csv"));
  std::vector<fsw::filter::Burn> burns;
  for (std::string line; std::getline(file, line);) {
    double t = 0.0;
    Vector3 dv;
    char comma = 0;
    std::istringstream fields(line);
    if (fields >> t >> comma >> dv(0) >> comma >> dv(1) >> comma >> dv(2)) {
      burns.push_back({start + fsw::nearest_duration(t), dv});
    }
  }
  if (burns.size() != 68) throw std::runtime_error("burns.csv is damaged");
  return burns;
}

truth::SpacecraftSettings servicer_body() {
  return {"servicer",
          {},
          {.mass_kg = 154.0,
           .drag_area_m2 = 1.3,
           .drag_coefficient = 2.5,
           .radiation_area_m2 = 2.5,
           .radiation_coefficient = 1.32}};
}

truth::SpacecraftSettings target_body() {
  return {"target",
          {},
          {.mass_kg = 40.0,
           .drag_area_m2 = 0.38,
           .drag_coefficient = 2.25,
           .radiation_area_m2 = 0.55,
           .radiation_coefficient = 1.2}};
}

truth::TruthSettings truth_settings(double hours, bool all_forces) {
  truth::TruthSettings settings;
  settings.epoch = truth::gps_from_utc("2011-07-18T01:00:00Z");
  settings.end = settings.epoch + fsw::nearest_duration(hours * 3600.0 + 600.0);
  settings.data_directory = vbar::tests::source_path("data");
  if (all_forces) {
    settings.forces = {.drag = true,
                       .geomagnetic_index = truth::GeomagneticIndex::kThreeHourly,
                       .radiation_pressure = true,
                       .shadow = truth::Shadow::kConical,
                       .sun = true,
                       .moon = true,
                       .solid_tides = true,
                       .relativity = true};
  }
  return settings;
}

orbit::EarthOrientation telecommanded_earth(const truth::TruthModel& model, fsw::GpsTime start) {
  const auto now = model.data().earth_orientation->at(start);
  const auto later = model.data().earth_orientation->at(start, 86400.0);
  return {.epoch = start,
          .ut1_minus_gps_s = now.ut1_minus_tai_s + 19.0,
          .ut1_rate = (later.ut1_minus_tai_s - now.ut1_minus_tai_s) / 86400.0,
          .pole_x = now.pole_x,
          .pole_y = now.pole_y};
}

}  // namespace

TrueFlight fly_truly(double hours, bool all_forces) {
  const truth::TruthSettings settings = truth_settings(hours, all_forces);
  truth::TruthModel model(settings);
  const orbit::QnsElements servicer{7087300.0, 0.0015, -4.17e-8, 98.18 * kDegree, 207.0 * kDegree, -0.69 * kDegree};
  const orbit::QnsElements servicer_mean = must(orbit::mean_from_osculating(servicer));
  Vector6 roe;
  roe << -2000.0, -75000.0, 0.0, 0.0, 0.0, 0.0;
  const orbit::QnsElements target_mean = orbit::qns_from_roe(servicer_mean, roe / 7078138.944);
  truth::SpacecraftSettings first = servicer_body();
  truth::SpacecraftSettings second = target_body();
  first.osculating = must(orbit::cartesian_from_qns(servicer));
  second.osculating = must(orbit::cartesian_from_qns(must(orbit::osculating_from_mean(target_mean))));
  model.add_spacecraft(first);
  model.add_spacecraft(second);

  TrueFlight flight;
  flight.burns = load_burns(settings.epoch);
  flight.earth = telecommanded_earth(model, settings.epoch);
  truth::SunMoonInterpolator ephemeris;
  std::size_t next_burn = 0;
  const auto count = static_cast<std::size_t>(hours * 3600.0 / kImagePeriod_s + 1.5);
  for (std::size_t k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) * kImagePeriod_s;
    const fsw::GpsTime time = settings.epoch + fsw::nearest_duration(t);
    TrueEpoch epoch;
    epoch.time = time;
    for (std::size_t fix = 0; fix < epoch.receiver.size(); ++fix) {
      const double early = kGnssPeriod_s * static_cast<double>(epoch.receiver.size() - 1 - fix);
      if (early > t) continue;
      const fsw::GpsTime then = time - fsw::nearest_duration(early);
      for (; next_burn < flight.burns.size() && flight.burns[next_burn].time < then; ++next_burn) {
        model.advance_to(flight.burns[next_burn].time);
        model.apply_impulse_rtn(0, flight.burns[next_burn].dv_rtn);
      }
      model.advance_to(then);
      epoch.receiver[fix] = {then, model.state(0).position_eci};
    }
    epoch.servicer = model.state(0);
    epoch.target = model.state(1);
    epoch.sun_eci = ephemeris.at(truth::tt_of(settings.epoch, t)).sun_eci.normalized();
    epoch.is_target_lit = fsw::filter::is_sunlit(epoch.target.position_eci, epoch.sun_eci);
    flight.epochs.push_back(epoch);
  }
  return flight;
}

SimulatedSensors::SimulatedSensors(const TrueFlight& flight, const SensorErrors& errors, unsigned seed)
    : flight_(flight), errors_(errors), random_(seed) {
  const double angle = std::uniform_real_distribution<double>(0.0, 2.0 * M_PI)(random_);
  bias_ = errors.bias_arcsec * kArcsec * Vector2(std::cos(angle), std::sin(angle));
  brightness_offset_m_ = errors.brightness_offset_m * (1.0 + 0.5 * normal());
  shape_ = {normal(), normal()};
  gnss_slow_ = normal3();
  for (fsw::filter::Burn burn : flight.burns) {
    burn.dv_rtn += errors.burn_relative * burn.dv_rtn.norm() * normal3();
    known_burns_.push_back(burn);
  }
}

MeasuredEpoch SimulatedSensors::measure(std::size_t index) {
  const TrueEpoch& truth = flight_.epochs[index];
  MeasuredEpoch epoch;
  epoch.time = truth.time;
  epoch.sun_eci = truth.sun_eci;

  for (const auto& [time, position_eci] : truth.receiver) {
    if (time < flight_.epochs.front().time) continue;
    const double keep = std::exp(-kGnssPeriod_s / kGnssSlow_s);
    gnss_slow_ = keep * gnss_slow_ + std::sqrt(1.0 - keep * keep) * normal3();
    const Vector3 error = errors_.gnss_slow_m * gnss_slow_ + errors_.gnss_white_m * normal3();
    epoch.positions.push_back(
        {time, {position_eci + error, errors_.gnss_white_m * errors_.gnss_white_m * fsw::Matrix3::Identity(), 0.0}});
  }

  const double keep = std::exp(-kImagePeriod_s / errors_.shape_time_s);
  shape_ = keep * shape_ + std::sqrt(1.0 - keep * keep) * Vector2(normal(), normal());
  const Vector2 white(normal(), normal());
  const double chance = std::uniform_real_distribution<double>(0.0, 1.0)(random_);
  const Vector2 stray(std::uniform_real_distribution<double>(-1.0, 1.0)(random_),
                      std::uniform_real_distribution<double>(-1.0, 1.0)(random_));
  if (!truth.is_target_lit) return epoch;
  const Vector3 centre = fsw::target_tracking::centre_of_brightness(
      truth.target.position_eci, truth.servicer.position_eci, truth.sun_eci, {.to_sun_m = brightness_offset_m_});
  const Vector3 sight = centre - truth.servicer.position_eci;
  const double radius = kTargetRadius_m / sight.norm();
  Vector2 off = bias_ + errors_.bearing_arcsec * kArcsec * white + errors_.shape_share * radius * shape_;
  if (chance < errors_.outlier_share) off += 1.0 * kDegree * stray;
  const fsw::Matrix3 axes = fsw::target_tracking::bearing_axes(sight.normalized(), truth.servicer);
  fsw::target_tracking::BearingMeasurement bearing;
  bearing.time = truth.time;
  bearing.direction_eci = (sight.normalized() + axes.topRows<2>().transpose() * off).normalized();
  bearing.sigma = errors_.bearing_arcsec * kArcsec;
  bearing.apparent_radius = radius;
  epoch.bearing = bearing;
  return epoch;
}

fsw::filter::TargetApriori SimulatedSensors::apriori() {
  const TrueEpoch& truth = flight_.epochs.front();
  const orbit::QnsElements servicer = must(orbit::qns_from_cartesian(truth.servicer));
  Vector6 roe = must(orbit::roe_of_target(truth.servicer, truth.target));
  fsw::filter::TargetApriori apriori;
  apriori.time = truth.time;
  apriori.sigma_a_roe_m << 30.0, 1000.0, 200.0, 200.0, 200.0, 200.0;
  for (int k = 0; k < 6; ++k) roe(k) += apriori.sigma_a_roe_m(k) / servicer.a * normal();
  apriori.target = must(orbit::target_from_roe(servicer, roe));
  return apriori;
}

Vector3 true_position_rtn(const TrueEpoch& epoch) {
  return orbit::relative_state_rtn(epoch.servicer, epoch.target).position_rtn;
}

AnglesOnlyFlight::AnglesOnlyFlight(const fsw::filter::FilterSettings& blocks,
                                   const fsw::measurements::BearingSettings& bearings,
                                   const fsw::filter::TargetApriori& apriori)
    : filter_(std::make_unique<fsw::filter::RelativeNavigationFilter>()) {
  filter_->configure(blocks);
  filter_->set_apriori(apriori);
  bearings_.configure(bearings);
}

fsw::measurements::BearingEditStatus AnglesOnlyFlight::update(const MeasuredEpoch& epoch,
                                                              const std::vector<fsw::filter::Burn>& burns) {
  for (const auto& [time, position] : epoch.positions) {
    filter_->advance_to(time, burns);
    filter_->update_absolute_orbit(position);
  }
  filter_->advance_to(epoch.time, burns);
  return bearings_.process(epoch.time, epoch.bearing, epoch.sun_eci, *filter_);
}

double roe_nees(const TrueEpoch& epoch, const fsw::filter::RelativeNavigationFilter& filter) {
  const Vector6 true_roe = must(orbit::roe_of_target(epoch.servicer, epoch.target));
  const double a = must(orbit::qns_from_cartesian(epoch.servicer)).a;
  const Vector6 error = filter.a_roe_m() - a * true_roe;
  return error.dot(fsw::math::Cholesky6(filter.a_roe_covariance_m2()).solve(error));
}

double own_orbit_nees(const TrueEpoch& epoch, const fsw::filter::RelativeNavigationFilter& filter) {
  Vector6 error;
  error << filter.servicer().position_eci - epoch.servicer.position_eci,
      filter.servicer().velocity_eci - epoch.servicer.velocity_eci;
  return error.dot(fsw::math::Cholesky6(filter.absolute_orbit().covariance()).solve(error));
}

Vector3 estimated_position_rtn(const fsw::filter::RelativeNavigationFilter& filter) {
  return orbit::relative_state_rtn(filter.servicer(), must(filter.target())).position_rtn;
}

namespace {

using Information = Eigen::Matrix<double, 8, 8>;

constexpr double kDifferenceStep_m = 10.0;

/// Target orbits beside the true one: element k a little more and less.
std::array<orbit::CartesianState, 12> neighbours(const TrueEpoch& start, double& a) {
  const orbit::QnsElements servicer = orbit::qns_from_cartesian(start.servicer).value();
  const orbit::QnsElements target = orbit::qns_from_cartesian(start.target).value();
  const fsw::Vector6 roe = orbit::roe_from_qns(servicer, target);
  a = servicer.a;
  std::array<orbit::CartesianState, 12> result;
  for (int k = 0; k < 12; ++k) {
    fsw::Vector6 shifted = roe;
    shifted(k / 2) += (k % 2 == 0 ? kDifferenceStep_m : -kDifferenceStep_m) / a;
    result[static_cast<std::size_t>(k)] = orbit::cartesian_from_qns(orbit::qns_from_roe(servicer, shifted)).value();
  }
  return result;
}

}  // namespace

std::vector<double> position_bound(const TrueFlight& flight, const std::vector<std::size_t>& epochs,
                                   const BoundSettings& settings) {
  double a = 0.0;
  std::array<orbit::CartesianState, 12> orbits = neighbours(flight.epochs.front(), a);
  Information information = Information::Zero();
  for (int k = 0; k < 6; ++k) {
    information(k, k) = 1.0 / (settings.prior_sigma_a_roe_m(k) * settings.prior_sigma_a_roe_m(k));
  }
  // A bias that is not there is known all too well.
  const double bias_sigma = settings.bias_sigma > 0.0 ? settings.bias_sigma : 1e-12;
  for (int k = 6; k < 8; ++k) information(k, k) = 1.0 / (bias_sigma * bias_sigma);

  std::vector<double> bounds;
  for (std::size_t k = 0; k < flight.epochs.size() && bounds.size() < epochs.size(); ++k) {
    const TrueEpoch& epoch = flight.epochs[k];
    if (k > 0) {
      const TrueEpoch& last = flight.epochs[k - 1];
      const fsw::filter::Propagation propagation(last.time, flight.earth, last.sun_eci);
      for (orbit::CartesianState& o : orbits) o = propagation.coast(o, fsw::seconds(epoch.time - last.time));
    }
    Eigen::Matrix<double, 3, 6> moves;  // of the target's position, m, per metre of a * ROE at the start
    for (int j = 0; j < 6; ++j) {
      const auto plus = static_cast<std::size_t>(2 * j);
      moves.col(j) = (orbits[plus].position_eci - orbits[plus + 1].position_eci) / (2.0 * kDifferenceStep_m);
    }
    const fsw::Vector3 sight = epoch.target.position_eci - epoch.servicer.position_eci;
    const double range = sight.norm();
    if (epoch.is_target_lit) {
      Eigen::Matrix<double, 2, 8> slope;
      slope.leftCols<6>() =
          fsw::target_tracking::bearing_axes(sight / range, epoch.servicer).topRows<2>() * moves / range;
      slope.rightCols<2>().setIdentity();
      const double resolved = settings.resolved_share * kTargetRadius_m / range;
      const double variance = settings.bearing_sigma * settings.bearing_sigma + resolved * resolved;
      information += slope.transpose() * slope / variance;
    }
    if (k != epochs[bounds.size()]) continue;
    // Metres and radians: scaled to a unit diagonal before the inverse.
    const Eigen::Matrix<double, 8, 1> scale = information.diagonal().cwiseSqrt().cwiseInverse();
    const Information covariance = scale.asDiagonal() *
                                   Information(scale.asDiagonal() * information * scale.asDiagonal()).inverse() *
                                   scale.asDiagonal();
    bounds.push_back(std::sqrt((moves * covariance.topLeftCorner<6, 6>() * moves.transpose()).trace()));
  }
  if (bounds.size() != epochs.size()) throw std::invalid_argument("an epoch beyond the flight");
  return bounds;
}

}  // namespace vbar::test
