// Broadcast elements fitted to an orbit: the orbit is that of real broadcast ephemerides (IGS, 2011-10-20), sampled as
// SP3 holds it, so that the fit has an exact answer.

#include "host_sim/flown_gnss/ephemeris_fit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/twins/gnss/ephemeris_file.h"
#include "tests/support/paths.h"

namespace vbar::flown_gnss {
namespace {

using twins::gnss::Ephemeris;

const std::vector<Ephemeris>& broadcast() {
  static const std::vector<Ephemeris> sets =
      twins::gnss::read_ephemeris_file(vbar::tests::source_path("data/gps/gps_2011_10_20.csv")).satellites;
  return sets;
}

/// States of the first satellites every 15 min, four hours about noon.
orbit_files::OrbitFile sampled() {
  orbit_files::OrbitFile file;
  for (std::size_t k = 0; k < 3; ++k) {
    const Ephemeris& set = broadcast()[k];
    orbit_files::Track& track = file.tracks.emplace_back();
    track.object = name_of(set.satellite);
    track.frame = orbit_files::Frame::kItrf;
    for (int step = -10; step <= 10; ++step) {
      orbit_files::TimedState& state = track.states.emplace_back();
      state.time = broadcast()[0].toe + fsw::duration_of_seconds(900 * step);
      const auto model = satellite_state(set, state.time);
      state.state.position_eci = model.position_ecef;
      const double after_s = fsw::seconds(state.time - set.toe);
      state.clock_s = set.af0 + after_s * (set.af1 + after_s * set.af2);
    }
  }
  return file;
}

TEST(EphemerisFit, FindsABroadcastOrbitAgain) {
  FitSettings settings;
  const Fit fit = fit_ephemerides({sampled()}, settings, {});
  ASSERT_GE(fit.sets.size(), 6U);
  for (const FittedSet& one : fit.sets) {
    // The tolerance is a hundredth of the error of a broadcast orbit; positions of SP3 are rounded to a millimetre.
    EXPECT_LT(one.orbit_max_m, 0.02);
    EXPECT_LT(one.clock_max_m, 1e-4);
    const auto truth = std::ranges::find(broadcast(), one.elements.satellite, &Ephemeris::satellite);
    // Between the samples too, velocity included.
    const auto expected = satellite_state(*truth, one.elements.toe, 451.0);
    const auto fitted = satellite_state(one.elements, one.elements.toe, 451.0);
    EXPECT_LT((fitted.position_ecef - expected.position_ecef).norm(), 0.02);
    EXPECT_LT((fitted.velocity_ecef - expected.velocity_ecef).norm(), 1e-4);
    EXPECT_NEAR(fitted.clock_s, expected.clock_s, 1e-12);
  }
}

TEST(EphemerisFit, IsReadBackFromRinex) {
  const Fit fit = fit_ephemerides({sampled()}, {}, {});
  twins::gnss::BroadcastCorrections corrections;
  corrections.klobuchar.alpha = {4.657e-9, 1.490e-8, -5.960e-8, -1.192e-7};
  corrections.klobuchar.beta = {81920.0, 81920.0, -65540.0, -524300.0};
  const auto read =
      twins::gnss::read_rinex_sets(rinex_navigation(fit.sets, corrections), "fit.rnx", {true, false, false});
  EXPECT_EQ(read.corrections, corrections);
  ASSERT_EQ(read.satellites.size(), fit.sets.size());
  for (std::size_t k = 0; k < read.satellites.size(); ++k) {
    const Ephemeris& written = fit.sets[k].elements;
    EXPECT_EQ(read.satellites[k].satellite, written.satellite);
    EXPECT_EQ(read.satellites[k].toe, written.toe);
    const auto expected = satellite_state(written, written.toe, 3600.0);
    const auto found = satellite_state(read.satellites[k], written.toe, 3600.0);
    // Thirteen digits of an angle are 0.03 mm.
    EXPECT_LT((found.position_ecef - expected.position_ecef).norm(), 1e-3);
    EXPECT_NEAR(found.clock_s, expected.clock_s, 1e-13);
  }
}

TEST(EphemerisFit, IsThatOfTheAntenna) {
  const Fit centre = fit_ephemerides({sampled()}, {}, {});
  const Fit antenna = fit_ephemerides({sampled()}, {}, {{broadcast()[0].satellite.prn, 2.5}});
  ASSERT_EQ(centre.sets.size(), antenna.sets.size());
  for (std::size_t k = 0; k < centre.sets.size(); ++k) {
    const auto of = [](const FittedSet& set) { return satellite_state(set.elements, set.elements.toe).position_ecef; };
    const bool is_shifted = centre.sets[k].elements.satellite == broadcast()[0].satellite;
    EXPECT_NEAR(of(centre.sets[k]).norm() - of(antenna.sets[k]).norm(), is_shifted ? 2.5 : 0.0, 0.02);
  }
}

TEST(EphemerisFit, NamesWhatItLeavesOut) {
  orbit_files::OrbitFile file = sampled();
  for (orbit_files::TimedState& state : file.tracks[1].states) state.clock_s.reset();
  const Fit fit = fit_ephemerides({file}, {}, {});
  EXPECT_THAT(fit.left_out, testing::Contains(testing::HasSubstr("0 clocks in its arc")));
  file.tracks.clear();
  EXPECT_THROW(static_cast<void>(fit_ephemerides({file}, {}, {})), std::runtime_error);
}

std::string antex(std::string_view until, std::string_view up = "   2500.00") {
  const auto line = [](std::string content, std::string_view label) {
    content.resize(60, ' ');
    return content + std::string(label) + "\n";
  };
  std::string text =
      line("     1.4            M", "ANTEX VERSION / SYST") + line("", "END OF HEADER") + line("", "START OF ANTENNA") +
      line("BLOCK IIA           G01                 G032      1992-079A", "TYPE / SERIAL NO") +
      line("  1992    11    22     0     0    0.0000000", "VALID FROM") + line(std::string(until), "VALID UNTIL");
  for (const char* frequency : {"   G01", "   G02"})
    text += line(frequency, "START OF FREQUENCY") +
            line("    279.00      0.00" + std::string(up), "NORTH / EAST / UP") + line(frequency, "END OF FREQUENCY");
  return text + line("", "END OF ANTENNA");
}

TEST(PhaseCentres, AreThoseOfTheSatellitesInOrbit) {
  const fsw::GpsTime time = fsw::GpsTime{} + fsw::duration_of_seconds(1594 * 604800);
  const auto centres = read_phase_centres(antex("  2011    10    16    23    59   59.9999999"), "igs.atx", time);
  ASSERT_EQ(centres.size(), 1U);
  EXPECT_NEAR(centres.at(1), 2.5, 1e-12);
  const auto error = [&](const std::string& text) -> std::string {
    try {
      static_cast<void>(read_phase_centres(text, "igs.atx", time));
    } catch (const std::exception& what) {
      return what.what();
    }
    return "";
  };
  EXPECT_THAT(error(antex("  2008    10    16    23    59   59.9999999")), testing::HasSubstr("igs.atx:"));
  EXPECT_THAT(error(antex("  2011    10    16    23    59   59.9999999", "   25x0.00")),
              testing::HasSubstr("igs.atx:"));
  EXPECT_THAT(error("RINEX"), testing::HasSubstr("igs.atx:1: found"));
}

}  // namespace
}  // namespace vbar::flown_gnss
