// What a mission switches on acts, and nothing else; what cannot act is refused with one clear error, before the
// flight.

#include "host_sim/truth/force_list.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/truth/atmosphere/nrlmsise00.h"
#include "host_sim/truth/forces/gravity_coefficients.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth {
namespace {

using test::all_forces_settings;
using test::mango;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> names_of_forces(const TruthSettings& settings) {
  std::vector<std::string> names;
  for (const auto& force : make_forces(settings, load_force_data(settings), mango())) {
    names.emplace_back(force->name());
  }
  return names;
}

/// The message that a truth with changed settings, or its first spacecraft, ends with.
std::string error_with(const std::function<void(TruthSettings&, SpacecraftSettings&)>& change) {
  TruthSettings settings = all_forces_settings();
  SpacecraftSettings spacecraft = mango();
  change(settings, spacecraft);
  try {
    TruthModel model(settings);
    model.add_spacecraft(spacecraft);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

class ScratchFile {
 public:
  ScratchFile(const std::string& name, const std::string& text)
      : path_(std::filesystem::path(testing::TempDir()) / ("vbar_" + std::to_string(::getpid()) + "_" + name)) {
    std::ofstream(path_) << text;
  }
  ~ScratchFile() { std::filesystem::remove(path_); }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

TEST(ForceList, HasWhatIsSwitchedOn) {
  TruthSettings settings = all_forces_settings();
  EXPECT_THAT(names_of_forces(settings),
              ElementsAre("gravity", "drag", "radiation_pressure", "sun", "moon", "solid_tides", "relativity"));
  settings.forces = {};
  EXPECT_THAT(names_of_forces(settings), ElementsAre("gravity"));
  settings.forces.moon = true;
  EXPECT_THAT(names_of_forces(settings), ElementsAre("gravity", "moon"));
}

TEST(ForceList, SizesOfTheForcesInLowOrbit) {
  // At 700 km, m/s^2, against orders of magnitude that hold for any such satellite: J2 by 3/2 J2 GM R^2/r^4 (1.1e-2,
  // between half and all of it), radiation by P C_R A/m (9.7e-8), the Sun's and the Moon's tide by GM r/d^3 (one to two
  // times 2.8e-7 and 5.9e-7), the solid tides by k2 3/2 (R/r)^4 of these (up to a third), Schwarzschild by 3 GM/(c^2 r)
  // GM/r^2 (1.5e-8), drag below 1e-6 and above 1e-9 at the solar activity of 2011.
  TruthModel model(all_forces_settings());
  model.add_spacecraft(mango("mango", 2.2e7));  // half a revolution ahead: by day
  const std::vector<ForceAcceleration> shares = model.accelerations(0);
  const auto expect_between = [&](std::size_t i, double low, double high) {
    EXPECT_GT(shares.at(i).acceleration_eci.norm(), low) << shares.at(i).force;
    EXPECT_LT(shares.at(i).acceleration_eci.norm(), high) << shares.at(i).force;
  };
  expect_between(0, 0.5e-2, 1.2e-2 * 1.9);  // from half (equator) to all (pole) of 3 J2 GM R^2/r^4
  expect_between(1, 1e-9, 1e-6);
  expect_between(2, 0.96 * 9.7e-8, 1.04 * 9.7e-8);  // the Earth is 1.5 % beyond 1 au in July: 3 % less light
  expect_between(3, 0.9 * 2.8e-7, 2.1 * 2.8e-7);
  expect_between(4, 0.8 * 5.9e-7, 2.5 * 5.9e-7);  // the Moon's distance varies by 7 %, its tide by 21 %
  expect_between(5, 1e-8, 5e-7);
  expect_between(6, 0.5e-8, 3e-8);
}

TEST(ForceList, AForceWithoutWhatItNeedsIsRefused) {
  EXPECT_EQ(error_with([](TruthSettings&, SpacecraftSettings&) {}), "");
  EXPECT_EQ(error_with([](TruthSettings&, SpacecraftSettings& s) { s.surface.mass_kg = 0.0; }),
            "spacecraft \"mango\": drag needs mass_kg above 0; it has 0");
  EXPECT_EQ(error_with([](TruthSettings&, SpacecraftSettings& s) { s.surface.drag_area_m2 = 0.0; }),
            "spacecraft \"mango\": drag needs drag_area_m2 above 0; it has 0");
  EXPECT_EQ(error_with([](TruthSettings&, SpacecraftSettings& s) { s.surface.radiation_area_m2 = -1.0; }),
            "spacecraft \"mango\": radiation_pressure needs radiation_area_m2 above 0; it has -1");
  EXPECT_EQ(error_with([](TruthSettings& t, SpacecraftSettings& s) {
              t.forces = {};
              s.surface = {};
            }),
            "")
      << "gravity asks for no surface";
}

// The data end at a date; what a run needs is known before it.
TEST(ForceList, ARunOutsideTheDataIsRefusedAtItsStart) {
  const auto named = [](TruthSettings& t) {
    t.earth_orientation_file = "earth/eop_2009_2013.csv";
    t.space_weather_file = "earth/space_weather_2009_2013.csv";
  };
  EXPECT_THAT(error_with([&](TruthSettings& t, SpacecraftSettings&) {
                named(t);
                t.epoch = gps_from_utc("2008-12-31T00:00:00Z");
              }),
              AllOf(HasSubstr("eop_2009_2013.csv: the epoch needs it"), HasSubstr("2008-12-31")));
  EXPECT_THAT(error_with([&](TruthSettings& t, SpacecraftSettings&) {
                named(t);
                t.epoch = gps_from_utc("2013-12-20T00:00:00Z");
                t.end = gps_from_utc("2014-01-10T00:00:00Z");
              }),
              AllOf(HasSubstr("eop_2009_2013.csv"), HasSubstr("a run that ends at 2014-01-10T00:00:00Z")));
  // Indices of the 57 hours before: the first days of the series have none.
  EXPECT_THAT(error_with([&](TruthSettings& t, SpacecraftSettings&) {
                named(t);
                t.epoch = gps_from_utc("2009-01-02T00:00:00Z");
              }),
              AllOf(HasSubstr("space_weather_2009_2013.csv: the epoch needs it"), HasSubstr("2009-01-02")));
}

// What the data folder holds is used where it reaches; elsewhere the run flies, and says what it lacks.
TEST(ForceList, WithoutDataForTheDateItFliesAndSaysSo) {
  TruthSettings settings = all_forces_settings();
  EXPECT_TRUE(load_force_data(settings).notes.empty());
  settings.epoch = gps_from_utc("2026-11-20T00:00:00Z");
  settings.end = settings.epoch + fsw::duration_of_seconds(86400);
  const ForceData data = load_force_data(settings);
  ASSERT_EQ(data.notes.size(), 2U);
  EXPECT_THAT(data.notes[0],
              AllOf(HasSubstr("UT1 = UTC is assumed"), HasSubstr("up to 0.9 s (13.5 arcsec, 419 m on the equator)"),
                    HasSubstr("0.6 arcsec (19 m)")));
  EXPECT_THAT(data.notes[1], AllOf(HasSubstr("F10.7 = 150 and Ap = 15 are assumed"), HasSubstr("factor of")));
  TruthModel model(settings);
  model.add_spacecraft(mango());
  EXPECT_NO_THROW(model.advance_to(settings.epoch + fsw::duration_of_seconds(600)));

  settings = all_forces_settings();
  settings.earth_orientation_file = TruthSettings::kNone;
  settings.space_weather_file = TruthSettings::kConstant;
  EXPECT_THAT(load_force_data(settings).notes, ElementsAre(HasSubstr("The mission uses no Earth orientation"),
                                                           HasSubstr("The mission uses no space weather")));
}

// The factors that the note on constant space weather states, of this atmosphere model.
TEST(ForceList, DensityOverASolarCycle) {
  Nrlmsise00 model(std::make_shared<const Nrlmsise00Tables>(
      load_nrlmsise00_tables(test::kDataDirectory / "atmosphere/nrlmsise00.csv")));
  // Mean over the hours of a day on the equator at equinox.
  const auto density = [&](double altitude_km, double f107) {
    double sum = 0.0;
    for (int hour = 0; hour < 24; ++hour) {
      AtmosphereInput input;
      input.day_of_year = 80;
      input.altitude_km = altitude_km;
      input.local_solar_time_h = hour;
      input.ut_s = 3600.0 * hour;
      input.indices.f107 = input.indices.f107_average = f107;
      input.indices.ap_daily = 15.0;
      sum += model.at(input).density;
    }
    return sum;
  };
  EXPECT_NEAR(density(400.0, 230.0) / density(400.0, 70.0), 11.0, 1.0);
  EXPECT_NEAR(density(700.0, 230.0) / density(700.0, 70.0), 36.0, 2.0);
}

TEST(ForceList, PredictedDataAreRefusedWhereObservedOnesAreRequired) {
  const auto with = [](bool accept, const char* epoch) {
    return error_with([&](TruthSettings& t, SpacecraftSettings&) {
      t.earth_orientation_file = vbar::tests::source_path("tests/data/formats/finals2000a_2016_predicted.txt");
      t.space_weather_file = TruthSettings::kConstant;
      t.accept_predictions = accept;
      t.epoch = gps_from_utc(epoch);
      t.end = t.epoch + fsw::duration_of_seconds(86400);
    });
  };
  EXPECT_EQ(with(true, "2016-05-02T00:00:00Z"), "");
  EXPECT_EQ(with(false, "2016-04-20T00:00:00Z"), "");
  EXPECT_THAT(with(false, "2016-05-02T00:00:00Z"),
              HasSubstr("finals2000a_2016_predicted.txt: Earth orientation is predicted from 2016-04-27T00:00:00Z on; "
                        "accepted are observed values, unless truth.accept_predictions is true"));
}

TEST(ForceList, ATideFreeModelGetsThePermanentTide) {
  // The permanent deformation is 4.2e-9 of C20 (IERS Conventions 2010, section 6.2.2); gravity alone must hold it.
  TruthSettings settings = all_forces_settings();
  settings.forces = {};
  settings.gravity_file = vbar::tests::source_path("tests/data/formats/egm2008_8.gfc");
  settings.gravity_degree = settings.gravity_order = 8;
  GravityCoefficients zero_tide = load_gravity_coefficients(settings.gravity_file, 8);
  zero_tide.c[GravityCoefficients::index(2, 0)] += -4.4228e-8 * 0.31460 * 0.30190;
  const fsw::Vector3 r(4e6, -3e6, 5e6);
  const fsw::Vector3 expected = GravityField(zero_tide, 8, 8).perturbation_itrf(r);
  const ForceData data = load_force_data(settings);
  EXPECT_LT((data.gravity->perturbation_itrf(r) - expected).norm(), 1e-15 * expected.norm());
  ASSERT_EQ(data.notes.size(), 1U);
  EXPECT_THAT(data.notes[0], AllOf(HasSubstr("is tide-free"), HasSubstr("-4.20e-09 of C20"), HasSubstr("is added"),
                                   HasSubstr("truth.permanent_tide = false")));
}

TEST(ForceList, ATideFreeModelIsUsedAsPublishedWithoutThePermanentTide) {
  TruthSettings settings = all_forces_settings();
  settings.forces = {};
  settings.permanent_tide = false;
  settings.gravity_file = vbar::tests::source_path("tests/data/formats/egm2008_8.gfc");
  settings.gravity_degree = settings.gravity_order = 8;
  const fsw::Vector3 r(4e6, -3e6, 5e6);
  const fsw::Vector3 published =
      GravityField(load_gravity_coefficients(settings.gravity_file, 8), 8, 8).perturbation_itrf(r);
  const ForceData data = load_force_data(settings);
  EXPECT_EQ(data.gravity->perturbation_itrf(r), published);
  ASSERT_EQ(data.notes.size(), 1U);
  EXPECT_THAT(data.notes[0], HasSubstr("used as published"));
  // A zero-tide model holds the deformation; nothing is to be said of it.
  settings.gravity_file = TruthSettings{}.gravity_file;
  EXPECT_TRUE(load_force_data(settings).notes.empty());
}

TEST(ForceList, SpaceWeatherMustReachTheEnd) {
  // The shipped series, cut after 20 July 2011.
  const std::string text = text_of(test::kDataDirectory / "earth/space_weather_2009_2013.csv");
  const std::size_t cut = text.find("\n55763,");  // MJD of 21 July 2011
  ASSERT_NE(cut, std::string::npos);
  const ScratchFile file("space_weather.csv", text.substr(0, cut + 1));
  const auto with_end = [&](const char* end) {
    return error_with([&](TruthSettings& t, SpacecraftSettings&) {
      t.space_weather_file = file.path();
      t.end = gps_from_utc(end);
    });
  };
  EXPECT_EQ(with_end("2011-07-20T22:00:00Z"), "");
  EXPECT_THAT(with_end("2011-07-21T12:00:00Z"),
              AllOf(HasSubstr(file.path().string()), HasSubstr("a run that ends at 2011-07-21T12:00:00Z")));
}

TEST(ForceList, GravityFilesThatDoNotServeAreRefused) {
  const std::string text = text_of(test::kDataDirectory / "gravity/ggm05s_120.txt");
  const auto with_file = [](const std::filesystem::path& path, int degree) {
    return error_with([&](TruthSettings& t, SpacecraftSettings&) {
      t.gravity_file = path;
      t.gravity_degree = t.gravity_order = degree;
    });
  };
  EXPECT_THAT(with_file(test::kDataDirectory / "gravity/ggm05s_120.txt", 121),
              AllOf(HasSubstr("ggm05s_120.txt"), HasSubstr("degree 121"), HasSubstr("0 to 120")));
  const ScratchFile truncated("truncated.txt", text.substr(0, text.size() / 2));
  EXPECT_THAT(with_file(truncated.path(), 20), AllOf(HasSubstr(truncated.path().string()), HasSubstr("expected")));
  std::string other_tide = text;
  other_tide.replace(other_tide.find("zero_tide", other_tide.find("\ntide_system")), 9, "mean_tide");
  const ScratchFile mean_tide("mean_tide.txt", other_tide);
  EXPECT_THAT(with_file(mean_tide.path(), 20), AllOf(HasSubstr(mean_tide.path().string()), HasSubstr("mean_tide")))
      << "tides must know what the model holds of them";
}

TEST(ForceList, AnOrbitThatDragBringsDownEndsWithItsDate) {
  // At 150 km with the area of a sail: down within hours.
  TruthSettings settings = all_forces_settings();
  settings.gravity_degree = settings.gravity_order = 2;
  settings.tolerance = 1e-9;
  TruthModel model(settings);
  fsw::orbit::QnsElements low = test::servicer_elements();
  low.a = 6378137.0 + 150e3;
  low.ex = low.ey = 0.0;
  SpacecraftSettings sail{"sail", orbit_geometry(low, test::kGm).state, test::kMango};
  sail.surface.drag_area_m2 = 100.0;
  model.add_spacecraft(sail);
  std::string message;
  try {
    model.advance_to(settings.epoch + fsw::duration_of_seconds(86400));
  } catch (const std::domain_error& error) {
    message = error.what();
  }
  EXPECT_THAT(message, AllOf(HasSubstr("spacecraft \"sail\": re-enters"), HasSubstr("2011-07-18T")));
}

}  // namespace
}  // namespace vbar::truth
