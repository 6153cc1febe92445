#include "host_sim/truth/earth/space_weather.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/truth/earth/time_scales.h"
#include "tests/unit/host_sim/truth/truth_fixture.h"

namespace vbar::truth {
namespace {

using testing::HasSubstr;
using enum GeomagneticIndex;

SpaceWeather real_series() {
  return SpaceWeather::load(test::kDataDirectory / "earth/space_weather_2009_2013.csv");
}

TEST(SpaceWeather, GivesTheDaysIndicesAndYesterdaysFlux) {
  // CelesTrak's rows: 2011-07-17 observed F10.7 103.6; 2011-07-18 mean 96.3, daily Ap 6.
  const SpaceWeather series = real_series();
  for (const char* time : {"2011-07-18T00:00:00Z", "2011-07-18T13:00:00Z", "2011-07-18T23:59:59.999999999Z"}) {
    const SolarIndices indices = series.indices_at(gps_from_utc(time), kDaily);
    EXPECT_EQ(indices.f107, 103.6);
    EXPECT_EQ(indices.f107_average, 96.3);
    EXPECT_EQ(indices.ap_daily, 6.0);
    EXPECT_EQ(indices.geomagnetic_index, kDaily);
  }
}

TEST(SpaceWeather, GivesTheHistoryOfThreeHourlyAp) {
  // CelesTrak's ap of 2011-07-16 to 18: 3 3 4 5 3 4 4 3 | 4 5 2 3 3 4 5 6 | 3 9 6 9 5 5 4 6, worked out by hand for
  // 13 h UTC of the 18th, the fifth interval.
  const SolarIndices indices = real_series().indices_at(gps_from_utc("2011-07-18T13:00:00Z"), kThreeHourly);
  EXPECT_EQ(indices.ap_history[0], 5.0);
  EXPECT_EQ(indices.ap_history[1], 9.0);
  EXPECT_EQ(indices.ap_history[2], 6.0);
  EXPECT_EQ(indices.ap_history[3], 9.0);
  EXPECT_EQ(indices.ap_history[4], (3 + 6 + 5 + 4 + 3 + 3 + 2 + 5) / 8.0);  // 12 to 33 hours before
  EXPECT_EQ(indices.ap_history[5], (4 + 3 + 4 + 4 + 3 + 5 + 4 + 3) / 8.0);  // 36 to 57 hours before
  EXPECT_EQ(indices.f107, 103.6);
}

TEST(SpaceWeather, TellsWhenIndicesChange) {
  const fsw::GpsTime time = gps_from_utc("2011-07-18T01:00:00Z");
  EXPECT_EQ(SpaceWeather::next_change_after(time, kDaily), gps_from_utc("2011-07-19T00:00:00Z"));
  EXPECT_EQ(SpaceWeather::next_change_after(time, kThreeHourly), gps_from_utc("2011-07-18T03:00:00Z"));
  EXPECT_EQ(SpaceWeather::next_change_after(gps_from_utc("2011-07-18T03:00:00Z"), kThreeHourly),
            gps_from_utc("2011-07-18T06:00:00Z"));
  EXPECT_EQ(SpaceWeather::next_change_after(gps_from_utc("2011-07-18T00:00:00Z"), kDaily),
            gps_from_utc("2011-07-19T00:00:00Z"));
  // The leap second lengthens the day's last interval.
  const fsw::GpsTime leap = gps_from_utc("2012-06-30T23:59:60.5Z");
  EXPECT_EQ(SpaceWeather::next_change_after(leap, kThreeHourly), gps_from_utc("2012-07-01T00:00:00Z"));
  EXPECT_EQ(SpaceWeather::next_change_after(leap, kDaily), gps_from_utc("2012-07-01T00:00:00Z"));
}

TEST(SpaceWeather, ChangesWhereItSaysAndNowhereElse) {
  const SpaceWeather series = real_series();
  for (const GeomagneticIndex index : {kDaily, kThreeHourly}) {
    fsw::GpsTime time = gps_from_utc("2012-06-29T00:00:00Z");
    const fsw::GpsTime end = gps_from_utc("2012-07-03T00:00:00Z");
    while (time < end) {
      const fsw::GpsTime next = SpaceWeather::next_change_after(time, index);
      ASSERT_GT(next, time);
      const SolarIndices indices = series.indices_at(time, index);
      EXPECT_EQ(series.indices_at(next - fsw::Duration{1}, index), indices);
      EXPECT_FALSE(series.indices_at(next, index) == indices);
      time = next;
    }
  }
}

std::string refusal(const SpaceWeather& series, const char* time, GeomagneticIndex index) {
  try {
    series.indices_at(gps_from_utc(time), index);
  } catch (const std::out_of_range& error) {
    return error.what();
  }
  return "";
}

TEST(SpaceWeather, RefusesDatesWithoutTheirHistory) {
  const SpaceWeather series = real_series();
  EXPECT_THAT(
      refusal(series, "2009-01-01T23:59:59Z", kDaily),
      HasSubstr("no daily space weather at 2009-01-01T23:59:59Z: the data, with the history that is needed, reach "
                "from 2009-01-02T00:00:00Z to 2014-01-01T00:00:00Z"));
  EXPECT_EQ(refusal(series, "2009-01-02T00:00:00Z", kDaily), "");
  EXPECT_THAT(refusal(series, "2009-01-03T08:59:59Z", kThreeHourly), HasSubstr("from 2009-01-03T09:00:00Z"));
  EXPECT_EQ(refusal(series, "2009-01-03T09:00:00Z", kThreeHourly), "");
  EXPECT_EQ(refusal(series, "2013-12-31T23:59:59Z", kThreeHourly), "");
  EXPECT_THAT(refusal(series, "2014-01-01T00:00:00Z", kThreeHourly), HasSubstr("no three-hourly space weather"));
  EXPECT_THAT(refusal(series, "1985-01-01T00:00:00Z", kDaily), HasSubstr("1985-01-01"));
  EXPECT_THROW(series.indices_at({-1}, kDaily), std::out_of_range);
}

TEST(SpaceWeather, TheOtherSeriesIsWholeToo) {
  // CelesTrak's rows of 2021-12-31 (observed F10.7 101.5) and 2022-01-01 (mean 104.5, Ap 12).
  const SpaceWeather series = SpaceWeather::load(test::kDataDirectory / "earth/space_weather_swarm_2022.csv");
  const SolarIndices indices = series.indices_at(gps_from_utc("2022-01-01T01:30:00Z"), kDaily);
  EXPECT_EQ(indices.f107, 101.5);
  EXPECT_EQ(indices.f107_average, 104.5);
  EXPECT_EQ(indices.ap_daily, 12.0);
}

class SpaceWeatherFile : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }

  std::string message_for(const std::string& text) {
    std::ofstream(file_) << text;
    try {
      SpaceWeather::load(file_);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  const std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("vbar_space_weather_" + std::to_string(getpid()) + ".csv");
  const std::string header_ =
      "# comment\nmjd_utc,ap1,ap2,ap3,ap4,ap5,ap6,ap7,ap8,ap_daily,f107_observed,f107_observed_81d\n";
  const std::string rows_ =
      "55000,1,2,3,4,5,6,7,8,5,70,71\n55001,1,2,3,4,5,6,7,8,5,70,71\n55002,1,2,3,4,5,6,7,8,5,70,71\n"
      "55003,1,2,3,4,5,6,7,8,5,70,71\n";
};

TEST_F(SpaceWeatherFile, IsReadWhenWhole) {
  EXPECT_EQ(message_for(header_ + rows_), "");
}

TEST_F(SpaceWeatherFile, ErrorsNameFileAndLine) {
  EXPECT_THAT(message_for("a,b\n"),
              HasSubstr(file_.string() + ":1: found \"a,b\", expected space weather in one of the formats"));
  EXPECT_THAT(message_for(header_ + rows_ + "55005,1,2,3,4,5,6,7,8,5,70,71\n"),
              HasSubstr(":7: day 55005 follows day 55003"));
  EXPECT_THAT(message_for(header_ + rows_ + "55004,1,2,3,4,5,6,7,8,5,70\n"), HasSubstr(":7: found \"55004,"));
  EXPECT_THAT(message_for(header_ + rows_ + "55004,1,2,3,4,5,6,7,8,5,70,71,72\n"),
              HasSubstr("expected a whole MJD from 1980 to 2099 and 11 numbers"));
  EXPECT_THAT(message_for(header_ + rows_ + "55004,1,2,3,4,5,6,7,8,5,,71\n"),
              HasSubstr("expected a whole MJD from 1980 to 2099 and 11 numbers"));
  EXPECT_THAT(message_for(header_ + rows_ + "55004,1,2,3,4,5,6,7,8,5,nan,71\n"),
              HasSubstr("expected a whole MJD from 1980 to 2099 and 11 numbers"));
  EXPECT_THAT(message_for(header_ + rows_ + "55004,1,2,3,4,5,6,7,8,5,0,71\n"), HasSubstr("fluxes above 0"));
  EXPECT_THAT(message_for(header_ + rows_ + "55004,-1,2,3,4,5,6,7,8,5,70,71\n"), HasSubstr("ap of 0 to 400"));
  EXPECT_THAT(message_for(header_ + rows_ + "55004.5,1,2,3,4,5,6,7,8,5,70,71\n"), HasSubstr("a whole MJD"));
  EXPECT_THAT(message_for(header_), HasSubstr("0 days of space weather; at least 4 are needed"));
  EXPECT_THROW(SpaceWeather::load("/nonexistent/space_weather.csv"), std::runtime_error);
  EXPECT_THROW(SpaceWeather(std::vector<SpaceWeather::Day>(2)), std::invalid_argument);
  EXPECT_THROW(SpaceWeather(std::vector<SpaceWeather::Day>(5)), std::invalid_argument);  // all of one date
}

}  // namespace
}  // namespace vbar::truth
