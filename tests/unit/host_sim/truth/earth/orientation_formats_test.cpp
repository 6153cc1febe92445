// Published files of Earth orientation: numbers of the files themselves, and those of the table in data/earth after an
// independent writer has put them into the published columns.

#include "host_sim/truth/earth/orientation_formats.h"

#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include <erfa.h>
#include <erfam.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/earth/time_scales.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kArcsec = ERFA_DAS2R;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  EXPECT_TRUE(stream) << file;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::string published(const std::string& name) {
  return text_of(vbar::tests::source_path("tests/data/formats/" + name));
}

OrientationDays bundled() {
  return read_orientation(text_of(test::kDataDirectory / "earth/eop_2009_2013.csv"), "eop_2009_2013.csv");
}

const EarthOrientationSeries::Day& day_of(const OrientationDays& days, int mjd) {
  return days.at(static_cast<std::size_t>(mjd - days.front().mjd_utc));
}

std::string error_of(const std::string& text) {
  try {
    static_cast<void>(read_orientation(text, "eop.txt"));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

/// The values of the bundled table as text, so that nothing is rounded on the way.
struct Row {
  int mjd = 0;
  std::string x, y, ut1, dx, dy;
};
std::vector<Row> bundled_rows() {
  std::ifstream stream(test::kDataDirectory / "earth/eop_2009_2013.csv");
  std::vector<Row> rows;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with('#') || line.starts_with("mjd")) continue;
    std::istringstream fields(line);
    Row row;
    std::string mjd;
    for (std::string* const to : {&mjd, &row.x, &row.y, &row.ut1, &row.dx, &row.dy}) std::getline(fields, *to, ',');
    row.mjd = std::stoi(mjd);
    rows.push_back(row);
  }
  return rows;
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

/// FORMAT of series 20: four integers, the MJD, then 16 numbers.
std::string as_series_20(const std::vector<Row>& rows) {
  std::string text =
      "# EARTH ORIENTATION PARAMETER (EOP) PRODUCT CENTER CENTER (PARIS OBSERVATORY)\n"
      "# EOP (IERS) 20 C04 TIME SERIES  consistent with ITRF 2020 - sampled at 0h UTC\n";
  for (const Row& row : rows) {
    const Date date = date_of(row.mjd);
    text += fmt::format(
        "{:4}{:4}{:4}{:4}{:10.2f}{:>12}{:>12}{:>12}{:>12}{:>12}{:12.6f}{:12.6f}{:12.7f}{:12.6f}{:12.6f}{:12.7f}{:12.6f}"
        "{:12.6f}{:12.6f}{:12.6f}{:12.7f}\n",
        date.year, date.month, date.day, 0, static_cast<double>(row.mjd), row.x, row.y, row.ut1, row.dx, row.dy, 0.1,
        0.2, 0.001, 3e-5, 3e-5, 1e-5, 5e-5, 5e-5, 1e-5, 1e-5, 1e-5);
  }
  return text;
}

/// Columns of readme.finals2000A. dX and dY in mas.
std::string as_finals(const std::vector<Row>& rows, int first_predicted) {
  std::string text;
  for (const Row& row : rows) {
    const Date date = date_of(row.mjd);
    const char flag = row.mjd >= first_predicted ? 'P' : 'I';
    text += fmt::format(
        "{:02}{:2}{:2} {:8.2f} {} {:>9}{:9.6f} {:>9}{:9.6f}  {}{:>10}{:10.7f} {:7.4f}{:7.4f}  {} "
        "{:9.3f}{:9.3f} {:9.3f}{:9.3f}\n",
        date.year % 100, date.month, date.day, static_cast<double>(row.mjd), flag, row.x, 1e-5, row.y, 1e-5, flag,
        row.ut1, 1e-6, 1.0, 0.01, flag, 1e3 * std::stod(row.dx), 0.1, 1e3 * std::stod(row.dy), 0.1);
  }
  return text;
}

TEST(OrientationFormats, SeriesC04OfTheDaysOfTheMission) {
  // Paris Observatory, series 14, read as published: the table in data/earth was made from it, so every bit is equal.
  const OrientationDays days = read_orientation(published("eopc04_14_2011.txt"), "eopc04");
  const OrientationDays table = bundled();
  ASSERT_EQ(days.size(), 21U);
  for (const auto& day : days) {
    const auto& same = day_of(table, day.mjd_utc);
    EXPECT_EQ(day.orientation.ut1_minus_tai_s, same.orientation.ut1_minus_tai_s);
    EXPECT_EQ(day.orientation.pole_x, same.orientation.pole_x);
    EXPECT_EQ(day.orientation.pole_y, same.orientation.pole_y);
    EXPECT_EQ(day.orientation.cip_dx, same.orientation.cip_dx);
    EXPECT_EQ(day.orientation.cip_dy, same.orientation.cip_dy);
    EXPECT_FALSE(day.is_predicted);
  }
}

TEST(OrientationFormats, SeriesC04OfAnotherDistribution) {
  // The copy of Debian's python3-astropy: row of 2022-11-29.
  const OrientationDays days = read_orientation(published("eopc04_14_2022.txt"), "eopc04");
  const EarthOrientation& last = days.back().orientation;
  EXPECT_EQ(days.back().mjd_utc, 59912);
  EXPECT_DOUBLE_EQ(last.pole_x, 0.149881 * kArcsec);
  EXPECT_DOUBLE_EQ(last.pole_y, 0.189736 * kArcsec);
  EXPECT_DOUBLE_EQ(last.ut1_minus_tai_s, -0.0192085 - 37.0);
  EXPECT_DOUBLE_EQ(last.cip_dx, 0.000319 * kArcsec);
  EXPECT_DOUBLE_EQ(last.cip_dy, -0.000070 * kArcsec);
}

TEST(OrientationFormats, FinalsOfTwoYears) {
  // USNO, row of 2011-07-18: Bulletin A.
  const OrientationDays days = read_orientation(published("finals2000a_2011.txt"), "finals2000A");
  const EarthOrientation& o = day_of(days, 55760).orientation;
  EXPECT_DOUBLE_EQ(o.pole_x, 0.076541 * kArcsec);
  EXPECT_DOUBLE_EQ(o.pole_y, 0.447175 * kArcsec);
  EXPECT_DOUBLE_EQ(o.ut1_minus_tai_s, -0.2914214 - 34.0);
  // The two services agree to about 0.3 mas and, in UT1, 20 to 50 us.
  const OrientationDays table = bundled();
  for (const auto& day : days) {
    const EarthOrientation& other = day_of(table, day.mjd_utc).orientation;
    EXPECT_NEAR(day.orientation.pole_x, other.pole_x, 3e-4 * kArcsec);
    EXPECT_NEAR(day.orientation.pole_y, other.pole_y, 3e-4 * kArcsec);
    EXPECT_NEAR(day.orientation.ut1_minus_tai_s, other.ut1_minus_tai_s, 1e-4);
    EXPECT_NEAR(day.orientation.cip_dx, other.cip_dx, 5e-4 * kArcsec);
  }
  // Debian's python3-astropy has a file of 2016 with predictions, which begin on 2016-04-29.
  const OrientationDays later = read_orientation(published("finals2000a_2016_predicted.txt"), "finals2000A");
  EXPECT_FALSE(day_of(later, 57506).is_predicted);
  EXPECT_TRUE(day_of(later, 57507).is_predicted);
  const auto from = EarthOrientationSeries(later).predicted_from();
  ASSERT_TRUE(from);
  EXPECT_EQ(*from, gps_from_utc("2016-04-27T00:00:00Z"));  // the polynomial's first node
}

TEST(OrientationFormats, TheBundledNumbersInThePublishedColumns) {
  const std::vector<Row> rows = bundled_rows();
  const OrientationDays table = bundled();
  ASSERT_EQ(rows.size(), table.size());
  const OrientationDays series = read_orientation(as_series_20(rows), "eopc04.txt");
  const OrientationDays finals = read_orientation(as_finals(rows, 56000), "finals.txt");
  ASSERT_EQ(series.size(), table.size());
  ASSERT_EQ(finals.size(), table.size());
  for (std::size_t k = 0; k < table.size(); ++k) {
    const EarthOrientation &a = table[k].orientation, &b = series[k].orientation, &c = finals[k].orientation;
    EXPECT_TRUE(a.pole_x == b.pole_x && a.pole_y == b.pole_y && a.ut1_minus_tai_s == b.ut1_minus_tai_s &&
                a.cip_dx == b.cip_dx && a.cip_dy == b.cip_dy)
        << k;
    EXPECT_TRUE(a.pole_x == c.pole_x && a.pole_y == c.pole_y && a.ut1_minus_tai_s == c.ut1_minus_tai_s) << k;
    EXPECT_NEAR(a.cip_dx, c.cip_dx, 1e-16);  // rounding of mas
    EXPECT_EQ(finals[k].is_predicted, finals[k].mjd_utc >= 56000);
  }
}

// Earth rotation against ERFA on the same data: its own chain of IAU 2006/2000A, with Lagrange's polynomial written out
// again. 1e-9 rad is the requirement; the interpolated series is good to 1e-12.
TEST(OrientationFormats, EarthRotationAgreesWithErfaOnTheSameFile) {
  const auto series = std::make_shared<const EarthOrientationSeries>(
      read_orientation(published("finals2000a_2016_predicted.txt"), "finals2000A"));
  // Rows of 2016-04-30 to 05-03, MJD 57508 to 57511, as printed in the file.
  const auto days = read_orientation(published("finals2000a_2016_predicted.txt"), "finals2000A");
  const fsw::GpsTime epoch = gps_from_utc("2016-05-01T00:00:00Z");
  EarthRotation rotation(series, epoch);
  for (const double seconds : {100.0, 30000.0, 60000.5, 86000.0}) {
    const double t = seconds / 86400.0 + 1.0;  // days since the first node
    EarthOrientation o{};
    for (int i = 0; i < 4; ++i) {
      double weight = 1.0;
      for (int j = 0; j < 4; ++j)
        if (j != i) weight *= (t - j) / (i - j);
      const EarthOrientation& node = day_of(days, 57508 + i).orientation;
      o.ut1_minus_tai_s += weight * node.ut1_minus_tai_s;
      o.pole_x += weight * node.pole_x;
      o.pole_y += weight * node.pole_y;
      o.cip_dx += weight * node.cip_dx;
      o.cip_dy += weight * node.cip_dy;
    }
    constexpr double kTaiMinusUtc_s = 36.0;
    const double utc_day = 57509.0, tai = (seconds + kTaiMinusUtc_s) / 86400.0, tt = tai + 32.184 / 86400.0;
    double x = 0.0, y = 0.0, matrix[3][3], polar[3][3], celestial[3][3];
    eraXy06(ERFA_DJM0 + utc_day, tt, &x, &y);
    const double s = eraS06(ERFA_DJM0 + utc_day, tt, x, y);
    eraC2ixys(x + o.cip_dx, y + o.cip_dy, s, celestial);
    const double era = eraEra00(ERFA_DJM0 + utc_day, tai + o.ut1_minus_tai_s / 86400.0);
    eraPom00(o.pole_x, o.pole_y, eraSp00(ERFA_DJM0 + utc_day, tt), polar);
    eraC2tcio(celestial, era, polar, matrix);
    const fsw::Matrix3 expected = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&matrix[0][0]);
    EXPECT_LT(accuracy::largest_entry(rotation.R_itrf_gcrf_at(seconds) - expected), 1e-11) << seconds;
  }
}

TEST(OrientationFormats, WithoutDataUt1IsUtc) {
  const fsw::GpsTime epoch = gps_from_utc("2026-11-20T00:00:00Z");
  const auto series = EarthOrientationSeries::unknown(epoch);
  EXPECT_EQ(series.at(epoch).ut1_minus_tai_s, -37.0);
  EXPECT_EQ(series.at(epoch, 1e8).ut1_minus_tai_s, -37.0);
  EXPECT_EQ(series.at(epoch).pole_x, 0.0);
  EXPECT_FALSE(series.predicted_from());
}

TEST(OrientationFormats, InvalidFilesAreRefusedWithALine) {
  std::string finals = published("finals2000a_2011.txt");
  const auto changed = [&](std::size_t line, std::size_t column, const std::string& text) {
    std::string copy = finals;
    std::size_t at = 0;
    for (std::size_t k = 1; k < line; ++k) at = copy.find('\n', at) + 1;
    return error_of(copy.replace(at + column - 1, text.size(), text));
  };
  const std::size_t length = finals.find('\n') + 1;
  EXPECT_THAT(error_of(finals.substr(0, 3 * length) + finals.substr(4 * length)),
              HasSubstr("eop.txt:4: day 55754 follows day 55752; days must follow without gaps"));
  EXPECT_THAT(error_of(finals.substr(length, length) + finals.substr(0, length)),
              HasSubstr("eop.txt:2: day 55750 follows day 55751"));
  EXPECT_THAT(changed(2, 19, " 76.54100"),
              AllOf(HasSubstr("eop.txt:2: found a pole x of 76.541 arcsec"), HasSubstr("expected up to 1 arcsec")));
  EXPECT_THAT(changed(2, 98, "  -95.000"), HasSubstr("a dX (IAU 2000A) of -0.095 arcsec"));
  EXPECT_THAT(changed(3, 17, "X"), HasSubstr("eop.txt:3: found"));
  EXPECT_THAT(changed(3, 59, "          "), HasSubstr("expected UT1-UTC in s in columns 59 to 68"));
  EXPECT_THAT(changed(3, 8, "55753.00"), HasSubstr("found the MJD 55753, expected 55752"));
  EXPECT_THAT(error_of("a,b\n1,2\n"), AllOf(HasSubstr("eop.txt:1: found \"a,b\""), HasSubstr("IERS finals2000A")));
  EXPECT_THAT(error_of(""), HasSubstr("eop.txt:1:"));
  std::string series = published("eopc04_14_2011.txt");
  series.replace(series.find("55752"), 5, "55759");
  EXPECT_THAT(error_of(series), HasSubstr("found the MJD 55759, expected 55752, that of the row's date at 0h UTC"));
}

/// Columns of the IERS data centre, of which finals2000A has more behind them.
constexpr std::string_view kIersHead =
    "MJD;Year;Month;Day;Type;x_pole;sigma_x_pole;y_pole;sigma_y_pole;x_rate;sigma_x_rate;y_rate;sigma_y_rate;Type;"
    "UT1-UTC;sigma_UT1-UTC;LOD;sigma_LOD;Type;dPsi;sigma_dPsi;dEpsilon;sigma_dEpsilon;dX;sigma_dX;dY;sigma_dY";

/// `first_predicted` of finals2000A, whose dX and dY are in mas; nothing of C04, whose are in arcsec and which has no
/// types.
std::string as_iers_csv(const std::vector<Row>& rows, std::optional<int> first_predicted) {
  const bool is_finals = first_predicted.has_value();
  std::string text = fmt::format("{}{}\n", kIersHead, is_finals ? ";Type;bulB/x_pole;bulB/y_pole" : "");
  for (const Row& row : rows) {
    const Date date = date_of(row.mjd);
    const std::string_view type = !is_finals ? "" : row.mjd >= *first_predicted ? "prediction" : "final";
    const auto offset = [&](const std::string& arcsec) {
      return is_finals ? fmt::format("{:.3f}", 1e3 * std::stod(arcsec)) : arcsec;
    };
    text +=
        fmt::format("{};{};{:02};{:02};{};{};0.00003;{};0.00003;;;;;{};{};0.00001;1.1;0.01;{};;;;;{};0.1;{};0.1{}\n",
                    row.mjd, date.year, date.month, date.day, type, row.x, row.y, type, row.ut1, type, offset(row.dx),
                    offset(row.dy), is_finals ? ";final;.1;.2" : "");
  }
  if (is_finals) text += "56293;2013;01;01" + std::string(26, ';') + "\n";
  return text;
}

/// CelesTrak: FORMAT(I4,I3,I3,I6,2F10.6,2F11.7,4F10.6,I4), and its CSV.
std::string as_celestrak(const std::vector<Row>& rows, int first_predicted, bool as_csv) {
  std::string text = as_csv ? "DATE,MJD,X,Y,UT1-UTC,LOD,DPSI,DEPS,DX,DY,DAT,DATA_TYPE\n"
                            : "VERSION 1.1\n# EARTH ORIENTATION PARAMETERS (EOP) DATA\n# EOP (IERS) 20 C04 TIME "
                              "SERIES\nNUM_OBSERVED_POINTS 3\nBEGIN OBSERVED\n";
  for (const Row& row : rows) {
    const Date date = date_of(row.mjd);
    const bool is_predicted = row.mjd >= first_predicted;
    if (as_csv) {
      text += fmt::format("{}-{:02}-{:02},{},{},{},{},0.0008,-0.12,-0.01,{},{},34,{}\n", date.year, date.month,
                          date.day, row.mjd, row.x, row.y, row.ut1, row.dx, row.dy, is_predicted ? 'P' : 'O');
      continue;
    }
    if (row.mjd == first_predicted) text += "END OBSERVED\n\nNUM_PREDICTED_POINTS 2\nBEGIN PREDICTED\n";
    text += fmt::format("{:4} {:02} {:02}{:6}{:>10}{:>10}{:>11}{:11.7f}{:10.6f}{:10.6f}{:>10}{:>10}{:4}\n", date.year,
                        date.month, date.day, row.mjd, row.x, row.y, row.ut1, 0.0008, -0.12, -0.01, row.dx, row.dy, 34);
  }
  return as_csv ? text : text + "END PREDICTED\n";
}

void expect_bundled(const OrientationDays& days, const OrientationDays& table, int first_predicted) {
  ASSERT_EQ(days.size(), table.size());
  for (std::size_t k = 0; k < table.size(); ++k) {
    const EarthOrientation &a = table[k].orientation, &b = days[k].orientation;
    EXPECT_TRUE(a.pole_x == b.pole_x && a.pole_y == b.pole_y && a.ut1_minus_tai_s == b.ut1_minus_tai_s) << k;
    EXPECT_NEAR(a.cip_dx, b.cip_dx, 1e-16);  // rounding of mas
    EXPECT_NEAR(a.cip_dy, b.cip_dy, 1e-16);
    EXPECT_EQ(days[k].is_predicted, days[k].mjd_utc >= first_predicted);
  }
}

TEST(OrientationFormats, TheBundledNumbersAsCsvAndInCelestraksColumns) {
  constexpr int kNever = 99999, kFirstPredicted = 56000;
  std::vector<Row> rows = bundled_rows();
  OrientationDays table = bundled();
  while (table.back().mjd_utc > 56292) table.pop_back();  // 2012-12-31
  rows.resize(table.size());
  expect_bundled(read_orientation(as_iers_csv(rows, std::nullopt), "eopc04.csv"), table, kNever);
  expect_bundled(read_orientation(as_iers_csv(rows, kFirstPredicted), "finals2000A.all.csv"), table, kFirstPredicted);
  expect_bundled(read_orientation(as_celestrak(rows, kFirstPredicted, true), "EOP-All.csv"), table, kFirstPredicted);
  expect_bundled(read_orientation(as_celestrak(rows, kFirstPredicted, false), "EOP-All.txt"), table, kFirstPredicted);
}

// Row of 2026-09-14 as the IERS data centre distributes finals2000A.all.csv, of which the offsets are in mas.
TEST(OrientationFormats, ARowOfTheIersDataCentre) {
  const std::string tail = std::string(10, ';');
  const std::string head =
      std::string(kIersHead) +
      ";Type;bulB/x_pole;bulB/y_pole;Type;bulB/UT-UTC;Type;bulB/dPsi;bulB/dEpsilon;bulB/dX;bulB/dY\n";
  const std::string row =
      "61297;2026;09;14;final;0.192933;0.000090;0.330554;0.000090;;;;;final;-0.0061769;0.0000273;1.0465;0.0178;"
      "prediction;"
      ";;;;0.052;0.128;0.218;0.160" +
      tail + "\n";
  const OrientationDays days = read_orientation(head + row, "finals2000A.all.csv");
  ASSERT_EQ(days.size(), 1U);
  EXPECT_DOUBLE_EQ(days[0].orientation.pole_x, 0.192933 * kArcsec);
  EXPECT_DOUBLE_EQ(days[0].orientation.pole_y, 0.330554 * kArcsec);
  EXPECT_DOUBLE_EQ(days[0].orientation.ut1_minus_tai_s, -0.0061769 - 37.0);
  EXPECT_DOUBLE_EQ(days[0].orientation.cip_dx, 0.052e-3 * kArcsec);
  EXPECT_FALSE(days[0].is_predicted);
  const auto replaced = [&](std::string text, std::string_view what, std::string_view with) {
    return error_of(head + text.replace(text.find(what), what.size(), with));
  };
  EXPECT_THAT(
      replaced(row, ";;;;0.052;0.128;0.218;0.160", "-114.9;.5;-8.6;.3;;;;"),
      AllOf(HasSubstr("eop.txt:2: found offsets dPsi and dEpsilon (IAU 1980)"), HasSubstr("finals2000A and C04")));
  EXPECT_THAT(replaced(row, "61297", "61297.5"), HasSubstr("found the MJD 61297.5, expected 61297"));
  EXPECT_THAT(replaced(row, ";final;0.19", ";finl;0.19"),
              HasSubstr("found the type \"finl\", expected final, prediction"));
  EXPECT_THAT(replaced(row, "0.192933", "0.19293x"), HasSubstr("found \"0.19293x\", expected a number as x_pole"));
  EXPECT_THAT(replaced(row, tail, ""), HasSubstr("found 27 values, expected one for each of 37 columns"));
  EXPECT_THAT(error_of("MJD;Year;Month;Day;x_pole\n"), HasSubstr("expected a column"));
}

// 9 mas of the pole or 90: the same digits without the last.
TEST(OrientationFormats, ANumberThatIsCutShortIsRefused) {
  const std::string finals = published("finals2000a_2011.txt");
  const std::size_t second = finals.find('\n') + 1;
  EXPECT_THAT(error_of(finals.substr(0, second + 124)),
              HasSubstr("eop.txt:2: found"));  // within dY, columns 117 to 125
  const std::string rows = as_celestrak(bundled_rows(), 99999, false);
  const std::size_t row = rows.find("BEGIN OBSERVED\n") + 15;
  EXPECT_THAT(error_of(rows.substr(0, row + 97)), HasSubstr("dY in arcsec in columns 89 to 98"));
  EXPECT_THAT(error_of("mjd_utc,x_arcsec,y_arcsec,ut1_minus_utc_s,dx_arcsec,dy_arcsec\n55004,0,0,0,0,0.00"),
              HasSubstr("found a last row without a line feed"));
}

// The type of a day, as CelesTrak has it, cannot be cut short; its offset dY can, where a file ends with it.
TEST(OrientationFormats, ALastValueThatIsCutShortIsRefused) {
  const std::string head = "MJD;Year;Month;Day;Type;x_pole;y_pole;Type;UT1-UTC;dPsi;dEps;dX;dY\n";
  const std::string row = "61297;2026;9;14;final;0.192933;0.301;final;0.05;;;0.1;0.25";
  EXPECT_EQ(error_of(head + row + "\n"), "");
  EXPECT_THAT(error_of(head + row), HasSubstr("eop.txt:2: found a last row without a line feed"));
}

}  // namespace
}  // namespace vbar::truth
