#include "host_sim/truth/earth/space_weather.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <erfa.h>
#include <erfam.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/earth/weather_formats.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

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

// CSSI space weather as published: the file that CelesTrak distributed for the weeks of data/earth's excerpt, and the
// numbers of data/earth after an independent writer has put them into both published layouts.

namespace {

using Kind = SpaceWeather::Kind;
using testing::AllOf;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  EXPECT_TRUE(stream) << file;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

WeatherDays table(const std::string& name) {
  return read_weather(text_of(test::kDataDirectory / "earth" / name), name);
}

std::string error_of(const std::string& text) {
  try {
    static_cast<void>(read_weather(text, "sw.txt"));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

void expect_same(const WeatherDays& days, const WeatherDays& expected) {
  ASSERT_EQ(days.size(), expected.size());
  for (std::size_t k = 0; k < days.size(); ++k) {
    EXPECT_EQ(days[k].mjd_utc, expected[k].mjd_utc);
    EXPECT_EQ(days[k].ap, expected[k].ap) << days[k].mjd_utc;
    EXPECT_EQ(days[k].ap_daily, expected[k].ap_daily) << days[k].mjd_utc;
    EXPECT_EQ(days[k].f107, expected[k].f107) << days[k].mjd_utc;
    EXPECT_EQ(days[k].f107_average, expected[k].f107_average) << days[k].mjd_utc;
  }
}

struct Date {
  int year = 0, month = 0, day = 0;
};
Date date_of(int mjd) {
  Date date;
  double fraction = 0.0;
  EXPECT_EQ(eraJd2cal(ERFA_DJM0, mjd, &date.year, &date.month, &date.day, &fraction), 0);
  return date;
}

/// FORMAT(I4,I3,I3,I5,I3,8I3,I4,8I4,I4,F4.1,I2,I4,F6.1,I2,5F6.1), with other numbers where nothing is read.
std::string text_row(const SpaceWeather::Day& day, bool is_monthly = false) {
  const Date date = date_of(day.mjd_utc);
  std::string row = fmt::format("{:4} {:02} {:02}{:5}{:3}", date.year, date.month, date.day, 2400, 1);
  if (is_monthly) {
    row += std::string(8 * 3 + 4 + 8 * 4 + 4 + 4 + 2, ' ');
  } else {
    for (int k = 0; k < 8; ++k) row += fmt::format("{:3}", 20);
    row += fmt::format("{:4}", 160);
    for (const double ap : day.ap) row += fmt::format("{:4.0f}", ap);
    row += fmt::format("{:4.0f}{:4.1f}{:2}", day.ap_daily, 0.4, 2);
  }
  return row + fmt::format("{:4}{:6.1f}{:2}{:6.1f}{:6.1f}{:6.1f}{:6.1f}{:6.1f}\n", 10, 66.6, is_monthly ? 0 : 0, 61.1,
                           62.2, day.f107, day.f107_average, 63.3);
}

std::string csv_row(const SpaceWeather::Day& day, std::string_view type) {
  const Date date = date_of(day.mjd_utc);
  std::string row = fmt::format("{:04}-{:02}-{:02},2400,1", date.year, date.month, date.day);
  for (int k = 0; k < 9; ++k) row += type == "PRM" ? "," : ",20";
  for (const double ap : day.ap) row += type == "PRM" ? "," : fmt::format(",{}", ap);
  row += type == "PRM" ? ",,," : fmt::format(",{},0.4,2", day.ap_daily);
  return row + fmt::format(",10,{},66.6,{},{},62.2,61.1,63.3\n", day.f107, type, day.f107_average);
}

constexpr std::string_view kCsvHead =
    "DATE,BSRN,ND,KP1,KP2,KP3,KP4,KP5,KP6,KP7,KP8,KP_SUM,AP1,AP2,AP3,AP4,AP5,AP6,AP7,AP8,AP_AVG,CP,C9,ISN,F10.7_OBS,"
    "F10.7_ADJ,F10.7_DATA_TYPE,F10.7_OBS_CENTER81,F10.7_OBS_LAST81,F10.7_ADJ_CENTER81,F10.7_ADJ_LAST81\n";

TEST(WeatherFormats, TheFileAsPublishedHoldsTheBundledNumbers) {
  expect_same(read_weather(text_of(vbar::tests::source_path("tests/data/formats/cssi_2021_2022.txt")), "SW.txt"),
              table("space_weather_swarm_2022.csv"));
}

TEST(WeatherFormats, TheBundledNumbersInBothLayouts) {
  const WeatherDays days = table("space_weather_2009_2013.csv");
  std::string text = "DATATYPE CssiSpaceWeather\nVERSION 1.2\n#\nNUM_OBSERVED_POINTS 1826\nBEGIN OBSERVED\n";
  std::string csv(kCsvHead);
  for (const SpaceWeather::Day& day : days) {
    text += text_row(day);
    csv += csv_row(day, "OBS");
  }
  expect_same(read_weather(text + "END OBSERVED\n", "SW-All.txt"), days);
  expect_same(read_weather(csv, "SW-All.csv"), days);
}

TEST(WeatherFormats, ARowAsCelesTrakWritesIt) {
  // CelesTrak's SW-All.csv, row of 2000-01-01.
  const WeatherDays days = read_weather(
      std::string(kCsvHead).append("2000-01-01,2272,7,53,47,40,33,43,30,43,37,327,56,39,27,18,32,15,32,22,30,1.3,6,71,"
                                   "129.9,125.6,OBS,166.2,179.0,161.1,175.0\n"),
      "SW-All.csv");
  ASSERT_EQ(days.size(), 1U);
  EXPECT_EQ(days[0].mjd_utc, 51544);
  EXPECT_EQ(days[0].ap, (std::array<double, 8>{56, 39, 27, 18, 32, 15, 32, 22}));
  EXPECT_EQ(days[0].ap_daily, 30.0);
  EXPECT_EQ(days[0].f107, 129.9);
  EXPECT_EQ(days[0].f107_average, 166.2);
}

/// Three observed days, two predicted ones, and the first days of two months.
std::string with_predictions(bool as_csv) {
  SpaceWeather::Day day{.ap = {4, 4, 4, 4, 4, 4, 4, 4}, .ap_daily = 4, .f107 = 100.0, .f107_average = 110.0};
  const int first = 61370;  // 2026-11-26
  std::string text = as_csv ? std::string(kCsvHead) : "DATATYPE CssiSpaceWeather\nBEGIN OBSERVED\n";
  const auto add = [&](int mjd, double f107, const char* type) {
    day.mjd_utc = mjd;
    day.f107 = f107;
    text += as_csv ? csv_row(day, type) : text_row(day, std::string_view(type) == "PRM");
  };
  for (int k = 0; k < 3; ++k) add(first + k, 100.0, "OBS");
  if (!as_csv) text += "END OBSERVED\n\nNUM_DAILY_PREDICTED_POINTS 2\nBEGIN DAILY_PREDICTED\n";
  for (int k = 3; k < 5; ++k) add(first + k, 100.0, "PRD");
  if (!as_csv) text += "END DAILY_PREDICTED\n\nBEGIN MONTHLY_PREDICTED\n";
  add(61375, 101.0, "PRM");  // 2026-12-01: one day behind the last
  add(61406, 132.0, "PRM");  // 2027-01-01: 31 days later
  if (!as_csv) text += "END MONTHLY_PREDICTED\n";
  return text;
}

TEST(WeatherFormats, PredictionsAreToldFromObservations) {
  for (const bool as_csv : {false, true}) {
    const WeatherDays days = read_weather(with_predictions(as_csv), "SW");
    ASSERT_EQ(days.size(), 37U) << as_csv;
    EXPECT_EQ(days[2].kind, Kind::kObserved);
    EXPECT_EQ(days[3].kind, Kind::kPredictedDaily);
    EXPECT_EQ(days[5].kind, Kind::kPredictedMonthly);
    // Between months: linear in the flux, with an assumed index.
    EXPECT_DOUBLE_EQ(days[15].f107, 111.0);
    EXPECT_EQ(days[15].ap_daily, SpaceWeather::kAssumedAp);
    EXPECT_EQ(days[36].f107, 132.0);
    const SpaceWeather series(days);
    const auto first = [&](Kind kind, const char* begin, const char* end) {
      const auto* const day = series.find_first(kind, gps_from_utc(begin), gps_from_utc(end));
      return day == nullptr ? 0 : day->mjd_utc;
    };
    EXPECT_EQ(first(Kind::kPredictedDaily, "2026-11-27T00:00:00Z", "2026-11-28T12:00:00Z"), 0);
    EXPECT_EQ(first(Kind::kPredictedDaily, "2026-11-27T00:00:00Z", "2026-11-29T12:00:00Z"), 61373);
    EXPECT_EQ(first(Kind::kPredictedMonthly, "2026-11-27T00:00:00Z", "2026-12-20T12:00:00Z"), 61375);
  }
}

TEST(WeatherFormats, ConstantIndicesHoldAtAnyTime) {
  const SpaceWeather weather = SpaceWeather::constant(140.0, 12.0);
  for (const char* const time : {"1981-01-01T00:00:00Z", "2026-11-25T12:00:00Z"}) {
    const SolarIndices daily = weather.indices_at(gps_from_utc(time), GeomagneticIndex::kDaily);
    EXPECT_EQ(daily.f107, 140.0);
    EXPECT_EQ(daily.f107_average, 140.0);
    EXPECT_EQ(daily.ap_daily, 12.0);
    EXPECT_EQ(weather.indices_at(gps_from_utc(time), GeomagneticIndex::kThreeHourly).ap_history[5], 12.0);
  }
}

TEST(WeatherFormats, InvalidFilesAreRefusedWithALine) {
  const std::string text = with_predictions(false), csv = with_predictions(true);
  const auto replaced = [](std::string where, std::string_view what, std::string_view with) {
    return error_of(where.replace(where.find(what), what.size(), with));
  };
  EXPECT_THAT(replaced(text, "2026 11 27", "2026 11 25"),
              HasSubstr("sw.txt:4: day 61369 follows day 61370; days must follow without gaps"));
  EXPECT_THAT(replaced(text, "2026 11 27", "2026 11 28"), HasSubstr("sw.txt:4: day 61372 follows day 61370"));
  EXPECT_THAT(replaced(csv, "2026-11-27", "2026-02-30"), HasSubstr("found the date 2026-02-30"));
  EXPECT_THAT(replaced(csv, "OBS,110", "XYZ,110"), AllOf(HasSubstr("sw.txt:2: found \"XYZ\""), HasSubstr("PRM")));
  EXPECT_THAT(replaced(csv, ",100,", ",1e-20,"), HasSubstr("found a flux F10.7 (1e-22 W/m^2/Hz) of 1e-20"));
  EXPECT_THAT(replaced(csv, ",4,4,4", ",900,4,4"), HasSubstr("found an ap of 900, expected 0 to 400"));
  EXPECT_THAT(replaced(csv, "F10.7_OBS,", "F10.7,"), HasSubstr("expected a column F10.7_OBS"));
  EXPECT_THAT(replaced(text, "END MONTHLY_PREDICTED\n", ""), HasSubstr("expected the END of the section"));
  EXPECT_THAT(replaced(text, "2027 01 01", "2027 06 01"), HasSubstr("found a month 182 days behind the row before"));
  EXPECT_THAT(error_of("x\n"), HasSubstr("CSSI space weather"));
}

TEST(WeatherFormats, ARowWithoutAValueIsADayWithoutData) {
  std::string csv = with_predictions(true);
  const std::size_t row = csv.find("2026-11-27");
  const std::size_t ap = csv.find(",4,4,4", row);
  csv.replace(ap, 2, ",");
  const WeatherDays days = read_weather(csv, "SW");
  EXPECT_EQ(days[1].kind, Kind::kMissing);
  EXPECT_EQ(days[1].line, 3);
}

// SpaceWeather-All-v1.2 of AGI has fluxes of 0 on 43 days, the first in 1957.
TEST(WeatherFormats, AFluxOfZeroIsADayWithoutData) {
  for (const bool as_csv : {false, true}) {
    std::string text = with_predictions(as_csv);
    const std::size_t flux =
        text.find(as_csv ? ",100," : " 100.0 110.0", text.find(as_csv ? "2026-11-27" : "2026 11 27"));
    text.replace(flux, as_csv ? 5 : 6, as_csv ? ",0.0," : "   0.0");
    const WeatherDays days = read_weather(text, "SW");
    ASSERT_EQ(days.size(), 37U) << as_csv;
    EXPECT_EQ(days[0].kind, Kind::kObserved);
    EXPECT_EQ(days[1].kind, Kind::kMissing);
    EXPECT_EQ(days[2].kind, Kind::kObserved);
  }
}

TEST(WeatherFormats, OfDaysBeforeGpsTimeOnlyTheDateIsLookedAt) {
  const SpaceWeather::Day day{.mjd_utc = 44243, .ap_daily = 4, .f107 = 0.0, .f107_average = 999.9};  // 1980-01-05
  SpaceWeather::Day next = day;
  next.mjd_utc = 44244;
  next.f107 = next.f107_average = 100.0;
  std::string old = text_row(day);
  old.replace(46, 4, " **X");  // ap1
  const WeatherDays days = read_weather("BEGIN OBSERVED\n" + old + text_row(next) + "END OBSERVED\n", "SW");
  ASSERT_EQ(days.size(), 1U);
  EXPECT_EQ(days[0].mjd_utc, 44244);
  old.replace(8, 2, "04");
  EXPECT_THAT(error_of("BEGIN OBSERVED\n" + old + text_row(next) + "END OBSERVED\n"), HasSubstr("without gaps"));
}

// Section of AGI's files behind the daily predictions, with a line of its own before it.
TEST(WeatherFormats, TheMonthlyFitIsAPrediction) {
  std::string text = with_predictions(false);
  const auto rename = [&](std::string_view what, std::string_view with) {
    text.replace(text.find(what), what.size(), with);
  };
  rename("BEGIN MONTHLY_PREDICTED\n",
         "BEGIN MONTHLY_PREDICTED\nEND MONTHLY_PREDICTED\n\nMONTHLY_FIT_TYPE  CSSI\nBEGIN MONTHLY_FIT\n");
  text.replace(text.rfind("END MONTHLY_PREDICTED"), 21, "END MONTHLY_FIT");
  const WeatherDays days = read_weather(text, "SW");
  ASSERT_EQ(days.size(), 37U);
  EXPECT_EQ(days[5].kind, Kind::kPredictedMonthly);
  EXPECT_EQ(days[36].f107, 132.0);
}

TEST(WeatherFormats, AFluxThatIsCutShortIsRefused) {
  std::string text = with_predictions(false);
  const std::size_t second = text.find("2026 11 27");
  text.resize(second + 122);  // the average 110.0 as 110
  EXPECT_THAT(error_of(text), AllOf(HasSubstr("sw.txt:4: found"), HasSubstr("the observed F10.7 of 81 days")));
  EXPECT_THAT(error_of("mjd_utc,ap1,ap2,ap3,ap4,ap5,ap6,ap7,ap8,ap_daily,f107_observed,f107_observed_81d\n"
                       "55004,1,2,3,4,5,6,7,8,5,70,7"),
              HasSubstr("sw.txt:2: found a last row without a line feed"));
}

}  // namespace

}  // namespace vbar::truth
