// Orbits of flown spacecraft, published by others and not part of this project. These tests run where the environment
// variable VBAR_FLIGHT_DATA names a folder with them (docs/flight.md states files and sources).

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "host_sim/orbit_fit/arc.h"
#include "host_sim/orbit_fit/batch.h"
#include "host_sim/orbit_fit/burn_search.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::orbit_fit {
namespace {

using fsw::Vector3;
using fsw::orbit::CartesianState;

class FlightData : public testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("VBAR_FLIGHT_DATA");
    if (folder == nullptr) GTEST_SKIP() << "VBAR_FLIGHT_DATA names no folder with the published orbits";
    folder_ = folder;
  }

  [[nodiscard]] orbit_files::OrbitFile orbit(const std::string& file) const {
    return orbit_files::tracks_of(orbit_files::load_orbits(folder_ / file), "");
  }

  std::filesystem::path folder_;
};

truth::TruthSettings all_forces() {
  truth::TruthSettings settings;
  settings.data_directory = truth::test::kDataDirectory;
  settings.gravity_degree = settings.gravity_order = 70;
  settings.forces = truth::test::kAllForces;
  return settings;
}

TEST_F(FlightData, Sentinel3aFitsOverADay) {
  const auto file = orbit("sentinel3a_2018/ssas3a20.b18358.e19003.DG_.sp3");
  const fsw::GpsTime from = truth::gps_from_utc("2018-12-30T00:00:23Z");
  const ArcSpan span = span_of(file, {from, from + fsw::duration_of_seconds(86400)});
  truth::TruthSettings settings = all_forces();
  settings.epoch = *span.from;
  settings.end = *span.to;
  settings.earth_orientation_file = "earth/eop_sentinel3a_2018.csv";
  settings.space_weather_file = "earth/space_weather_sentinel3a_2018.csv";
  const FittedDynamics dynamics(settings, "sentinel-3a", {1130.0, 7.0, 2.5, 18.0, 1.2}, true);
  const Arc arc = arc_of(file, span, dynamics.data().earth_orientation);
  OrbitParameters first;
  first.start = arc.first;
  accuracy::expect_below("Sentinel-3A over a day, root mean square distance",
                         "orbit of CNES (IDS); start, drag and radiation scale fitted",
                         Batch(dynamics, arc, 2).fit(first, {true, true}).rms_m, 0.15, "m");
}

TEST_F(FlightData, BurnsOfSpot5AreFoundInItsOrbitAlone) {
  const auto file = orbit("spot5_2010/ssasp501.b10170.e10181.D__.sp3");
  const fsw::GpsTime from = truth::gps_from_utc("2010-06-28T00:00:26Z");
  const ArcSpan span = span_of(file, {from, {}});
  truth::TruthSettings settings = all_forces();
  settings.epoch = *span.from;
  settings.end = *span.to;
  const FittedDynamics dynamics(settings, "spot-5", {2860.0, 12.0, 2.5, 30.0, 1.2}, true);
  const Arc arc = arc_of(file, span, dynamics.data().earth_orientation);
  OrbitParameters first;
  first.start = arc.first;
  const Batch batch(dynamics, arc, 2);
  const Estimated estimated{true, true};
  const FittedOrbit without = batch.fit(first, estimated);
  EXPECT_GT(without.rms_m, 30.0);
  const FittedOrbit with = fit_with_found_burns(batch, without, estimated, 4);
  EXPECT_LT(with.rms_m, 0.3);  // as its days without burns: 0.2
  ASSERT_EQ(with.parameters.burns.size(), 2U);
  // International DORIS Service, record of manoeuvres: 2010 day 179, 18:08:23.613 and 18:59:09.600 TAI.
  const char* const recorded[] = {"2010-06-28T18:07:49.613Z", "2010-06-28T18:58:35.600Z"};
  for (std::size_t k = 0; k < 2; ++k) {
    const Burn& burn = with.parameters.burns[k];
    EXPECT_NEAR(burn.seconds, fsw::seconds(truth::gps_from_utc(recorded[k]) - arc.epoch), 60.0);
    EXPECT_GT(burn.dv_rtn[1], 0.9 * burn.dv_rtn.norm());  // along track, forward
    // Recorded are 11.74 mm/s each. The orbit has 3 % more, whatever the arc and the forces.
    EXPECT_NEAR(burn.dv_rtn[1], 0.01174, 0.05 * 0.01174);
  }
}

/// CODE's orbit of one GRACE spacecraft on 2010-07-27: ECEF in km and dm/s, GPS time, every 10 s.
std::vector<CartesianState> grace(const std::filesystem::path& file, truth::EarthRotation& rotation) {
  std::vector<CartesianState> states;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    double x[6] = {}, hour = 0.0, minute = 0.0, second = 0.0;
    if (std::sscanf(line.c_str(), "%*[^,],%lf:%lf:%lf,%lf,%lf,%lf,%lf,%lf,%lf", &hour, &minute, &second, x, x + 1,
                    x + 2, x + 3, x + 4, x + 5) != 9)
      continue;
    const double seconds = 3600.0 * hour + 60.0 * minute + second;
    EXPECT_EQ(std::fmod(10.0 * static_cast<double>(states.size()), 86400.0), seconds);
    const CartesianState itrf{1e3 * Vector3(x[0], x[1], x[2]), 0.1 * Vector3(x[3], x[4], x[5])};
    states.push_back(
        orbit_files::gcrf_state(orbit_files::Frame::kItrf, itrf, rotation, 10.0 * static_cast<double>(states.size())));
  }
  return states;
}

fsw::orbit::QnsElements mean_of(const CartesianState& state) {
  return fsw::orbit::mean_from_osculating(fsw::orbit::qns_from_cartesian(state).value()).value();
}

TEST_F(FlightData, GracePairMovesAsTheFlightSoftwarePropagatesIt) {
  const fsw::GpsTime epoch = truth::gps_from_utc("2010-07-26T23:59:45Z");  // 2010-07-27 0h of GPS time
  truth::EarthRotation rotation(
      std::make_shared<const truth::EarthOrientationSeries>(
          truth::EarthOrientationSeries::load(truth::test::kDataDirectory / "earth/eop_2009_2013.csv")),
      epoch);
  const auto a = grace(folder_ / "grace_2010_208/grca_truth.csv", rotation);
  const auto b = grace(folder_ / "grace_2010_208/grcb_truth.csv", rotation);
  ASSERT_EQ(a.size(), 8641U);  // to 24 h
  ASSERT_EQ(b.size(), a.size());

  // K band: the range but for a bias of each connected piece, so differences of neighbours are compared.
  std::ifstream in(folder_ / "grace_2010_208/grc_kb_rng.csv");
  std::vector<double> difference;
  for (std::string line; std::getline(in, line);) {
    double hour = 0.0, minute = 0.0, second = 0.0, range = 0.0;
    if (std::sscanf(line.c_str(), "%*[^,],%lf:%lf:%lf,%lf", &hour, &minute, &second, &range) != 4) continue;
    const auto k = static_cast<std::size_t>(std::lround((3600.0 * hour + 60.0 * minute + second) / 10.0));
    difference.push_back((a[k].position_eci - b[k].position_eci).norm() - range);
  }
  ASSERT_GT(difference.size(), 8000U);
  double mean = 0.0, square = 0.0;
  for (const double one : difference) mean += one / static_cast<double>(difference.size());
  for (const double one : difference) square += (one - mean) * (one - mean) / static_cast<double>(difference.size());
  accuracy::record_table(
      "GRACE-A and -B: distance of CODE's orbits less K band",
      {{"epochs", "bias, m", "standard deviation, m"},
       {fmt::format("{}", difference.size()), fmt::format("{:.4f}", mean), fmt::format("{:.4f}", std::sqrt(square))}});
  // Published comparisons of reduced-dynamic orbits of the pair with K band: 1 to 2 cm without fixed ambiguities.
  EXPECT_LT(std::sqrt(square), 0.02);

  std::vector<std::vector<std::string>> table = {
      {"after", "starts", "error of position, m (root mean square)", "largest, m", "R, m", "T, m", "N, m"}};
  const auto fly = [&](int hours) {
    const auto ahead = static_cast<std::size_t>(360 * hours);
    double count = 0.0;
    accuracy::Largest largest;
    Vector3 squares = Vector3::Zero();
    for (std::size_t k = 0; k + ahead < a.size(); k += 60) {
      const auto chief = mean_of(a[k]);
      const fsw::Vector6 roe = fsw::orbit::roe_from_qns(chief, mean_of(b[k]));
      const fsw::Vector6 later = fsw::orbit::roe_transition_j2(chief, 3600.0 * hours) * roe;
      const auto predicted = fsw::orbit::relative_state_from_mean_roe(mean_of(a[k + ahead]), later).value();
      const Vector3 error =
          predicted.position_rtn - fsw::orbit::relative_state_rtn(a[k + ahead], b[k + ahead]).position_rtn;
      squares += error.cwiseAbs2();
      largest.add(error.norm());
      ++count;
    }
    const double rms = std::sqrt(squares.sum() / count);
    const Vector3 rms_rtn = (squares / count).cwiseSqrt();
    table.push_back({fmt::format("{} h", hours), fmt::format("{:.0f}", count), fmt::format("{:.1f}", rms),
                     fmt::format("{:.1f}", double{largest}), fmt::format("{:.1f}", rms_rtn[0]),
                     fmt::format("{:.1f}", rms_rtn[1]), fmt::format("{:.1f}", rms_rtn[2])});
    return rms;
  };
  EXPECT_LT(fly(0), 1e-3);  // the map and its inverse
  // 225 km apart. First-order mean elements of a pair: the short-period terms of J2^2 and of the field above J2 that
  // the map leaves in da (10 m) drift by 3/2 n da.
  EXPECT_LT(fly(1), 0.003 * 225e3);
  EXPECT_LT(fly(6), 0.01 * 225e3);
  EXPECT_LT(fly(12), 0.01 * 225e3);
  EXPECT_LT(fly(24), 0.01 * 225e3);
  accuracy::record_table("GRACE-B relative to GRACE-A by the linear model with J2, 225 km apart", table);
}

}  // namespace
}  // namespace vbar::orbit_fit
