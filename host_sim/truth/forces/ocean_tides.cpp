#include "host_sim/truth/forces/ocean_tides.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <erfa.h>
#include <erfam.h>
#include <fmt/format.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/files/text_lines.h"

namespace vbar::truth {

namespace {

constexpr int kDegree = kOceanTideDegree;
constexpr double kNodeStep_s = 600.0;
constexpr double kUnit = 1e-11;  // of the table

/// Returns the multipliers of a Doodson number "255.555" or "55.565": its first digit (0 if there are five) is that of
/// tau, the others are larger by 5.
std::array<int, 6> multipliers_of(const files::TextLines& lines, std::string_view doodson) {
  std::array<int, 6> multipliers{};
  const auto point = doodson.find('.');
  const bool is_well_formed =
      point != std::string_view::npos && point >= 2 && point <= 3 && doodson.size() == point + 4;
  std::string digits(is_well_formed ? 3 - point : 0, '0');
  for (const char c : doodson)
    if (c >= '0' && c <= '9') digits += c;
  if (!is_well_formed || digits.size() != 6) lines.refuse("a Doodson number as 255.555");
  for (std::size_t k = 0; k < 6; ++k) multipliers[k] = digits[k] - '0' - (k == 0 ? 0 : 5);
  return multipliers;
}

OceanTideTerm term_of(const files::TextLines& lines, const std::vector<std::string_view>& words) {
  const auto n = files::integer_of(words[2]), m = files::integer_of(words[3]);
  if (!n || !m || *n < 2 || *n > kDegree || *m < 0 || *m > *n)
    lines.refuse(fmt::format("a degree from 2 to {} and an order up to it", kDegree));
  std::array<double, 4> values{};
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto value = files::number_of(words[4 + k]);
    constexpr double kLargest = 1e4;  // the largest of FES2004 is below 1e2
    if (!value || std::abs(*value) > kLargest) lines.refuse(fmt::format("four coefficients up to {:g}", kLargest));
    values[k] = kUnit * *value;
  }
  return {*n, *m, values[0], values[1], values[2], values[3]};
}

}  // namespace

std::vector<OceanTideWave> read_ocean_tides(std::string_view text, const std::string& file) {
  files::TextLines lines(text, file);
  std::vector<OceanTideWave> waves;
  while (lines.next()) {
    if (lines.line().starts_with("#") || lines.is_blank()) continue;
    const std::vector<std::string_view> words = lines.words();
    if (words.size() == 1 && words.front() == "end" && !waves.empty()) return waves;
    if (words.size() != 8) lines.refuse("Doodson number, wave, n, m, C+, S+, C-, S-, or \"end\" behind the last line");
    if (waves.empty() || waves.back().doodson != words[0])
      waves.push_back({std::string(words[0]), multipliers_of(lines, words[0]), {}});
    waves.back().terms.push_back(term_of(lines, words));
  }
  lines.refuse("the end of the file", "\"end\" behind the last coefficients: the file is cut short");
}

std::vector<OceanTideWave> load_ocean_tides(const std::filesystem::path& file) {
  const files::DataStream stream(file);
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot open the ocean tide model", file.string()));
  return read_ocean_tides(stream.view(), file.string());
}

GravityCoefficients ocean_tide_coefficients(const std::vector<OceanTideWave>& waves, JulianDate tt, double gmst) {
  const double t = ((tt.day - ERFA_DJ00) + tt.fraction) / ERFA_DJC;
  // Doodson's variables from Delaunay's (IERS Conventions 2010, section 5.7.2).
  const double f = eraFaf03(t), d = eraFad03(t), node = eraFaom03(t);
  const double s = f + node, h = s - d;
  const std::array<double, 6> doodson = {gmst + std::numbers::pi - s, s, h, s - eraFal03(t), -node, h - eraFalp03(t)};
  GravityCoefficients change;
  change.degree = kDegree;
  change.c.assign(GravityCoefficients::index(kDegree + 1, 0), 0.0);
  change.s = change.c;
  for (const OceanTideWave& wave : waves) {
    double theta = 0.0;
    for (std::size_t k = 0; k < doodson.size(); ++k) theta += wave.multipliers[k] * doodson[k];
    const double cos = std::cos(theta), sin = std::sin(theta);
    for (const OceanTideTerm& term : wave.terms) {
      const std::size_t place = GravityCoefficients::index(term.n, term.m);
      change.c[place] += (term.c_plus + term.c_minus) * cos + (term.s_plus + term.s_minus) * sin;
      change.s[place] += (term.s_plus - term.s_minus) * cos - (term.c_plus - term.c_minus) * sin;
    }
  }
  return change;
}

OceanTidesForce::OceanTidesForce(double gm, double radius, fsw::GpsTime epoch,
                                 std::shared_ptr<const std::vector<OceanTideWave>> waves,
                                 std::shared_ptr<const EarthOrientationSeries> orientation)
    : gm_(gm), radius_(radius), epoch_(epoch), waves_(std::move(waves)), orientation_(std::move(orientation)) {
  if (!waves_ || !orientation_) throw std::invalid_argument("the ocean tides need their model and Earth orientation");
}

const GravityField& OceanTidesForce::node(std::int64_t index) {
  const auto found = nodes_.find(index);
  if (found != nodes_.end()) return found->second;
  const double seconds = kNodeStep_s * static_cast<double>(index);
  const JulianDate tt = tt_of(epoch_, seconds), tai = tai_of(epoch_, seconds);
  const JulianDate ut1 = ut1_of(tai, orientation_->at(epoch_, seconds).ut1_minus_tai_s);
  GravityCoefficients coefficients =
      ocean_tide_coefficients(*waves_, tt, eraGmst06(ut1.day, ut1.fraction, tt.day, tt.fraction));
  coefficients.gm = gm_;
  coefficients.radius = radius_;
  return nodes_.emplace(index, GravityField(coefficients, kDegree, kDegree)).first->second;
}

fsw::Vector3 OceanTidesForce::acceleration_eci(const ForceInput& input) {
  const double steps = input.seconds / kNodeStep_s, before = std::floor(steps), u = steps - before;
  const auto at = [&](int offset) {
    return node(static_cast<std::int64_t>(before) + offset).perturbation_itrf(input.position_itrf);
  };
  // Lagrange's cubic through the nodes -1, 0, 1, 2.
  const fsw::Vector3 itrf = -u * (u - 1.0) * (u - 2.0) / 6.0 * at(-1) +
                            (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0 * at(0) - (u + 1.0) * u * (u - 2.0) / 2.0 * at(1) +
                            (u + 1.0) * u * (u - 1.0) / 6.0 * at(2);
  return input.R_itrf_gcrf.transpose() * itrf;
}

}  // namespace vbar::truth
