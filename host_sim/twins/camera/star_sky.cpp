#include "host_sim/twins/camera/star_sky.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/twins/camera/aberration.h"
#include "host_sim/twins/camera/photometry.h"

namespace vbar::twins::camera {
namespace {

using fsw::Vector3;

constexpr std::string_view kColumns = "hip,ra_deg,dec_deg,pm_ra_mas,pm_dec_mas,v,b_v";
constexpr std::size_t kNumbers = 7;
constexpr double kFaintest = 7.995;  // the file's last star is at least as faint
constexpr double kDegree = M_PI / 180.0;
constexpr double kMilliarcsecond = kDegree / 3.6e6;

std::optional<std::array<double, kNumbers>> parse(std::string_view line) {
  std::array<double, kNumbers> numbers;
  const char* at = line.data();
  const char* const end = at + line.size();
  for (std::size_t column = 0; column < kNumbers; ++column) {
    const auto [next, error] = std::from_chars(at, end, numbers[column]);
    if (error != std::errc{} || !std::isfinite(numbers[column])) return std::nullopt;
    at = next;
    if (column + 1 < kNumbers && (at == end || *at++ != ',')) return std::nullopt;
  }
  if (at != end) return std::nullopt;
  return numbers;
}

bool is_star(const std::array<double, kNumbers>& n) {
  return n[0] >= 0.0 && n[0] == std::floor(n[0]) && n[1] >= 0.0 && n[1] < 360.0 && std::abs(n[2]) <= 90.0 &&
         std::abs(n[3]) < 2e4 && std::abs(n[4]) < 2e4 && n[5] > -2.0 && n[5] < 20.0 && std::abs(n[6]) < 10.0;
}

SkyStar star_of(const std::array<double, kNumbers>& n, double zero_magnitude_photons) {
  const double ra = n[1] * kDegree, dec = n[2] * kDegree;
  SkyStar star;
  star.hip = static_cast<int>(n[0]);
  star.direction_j2000 = Vector3(std::cos(dec) * std::cos(ra), std::cos(dec) * std::sin(ra), std::sin(dec));
  const Vector3 east(-std::sin(ra), std::cos(ra), 0.0);
  const Vector3 north = star.direction_j2000.cross(east);
  star.motion_per_year = kMilliarcsecond * (n[3] * east + n[4] * north);
  star.v = n[5];
  star.b_v = n[6];
  star.photons_per_m2_s = star_photons(zero_magnitude_photons, star.v, star.b_v);
  return star;
}

}  // namespace

StarSky StarSky::load(const std::filesystem::path& data_directory, double zero_magnitude_photons) {
  const std::filesystem::path file = data_directory / "stars" / "hipparcos_v8.csv";
  files::DataStream in(file);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot open the star catalogue", file.string()));
  StarSky sky;
  std::string line;
  int number = 0;
  bool columns_seen = false;
  double faintest = -10.0;
  const auto refuse = [&](std::string_view accepted) {
    throw std::runtime_error(fmt::format("{}:{}: found \"{}\", accepted: {}", file.string(), number, line, accepted));
  };
  while (std::getline(in, line)) {
    ++number;
    if (in.eof()) refuse("a line that ends: the star catalogue is cut short");
    if (line.starts_with('#')) continue;
    if (!columns_seen) {
      if (line != kColumns) refuse(fmt::format("the columns {}", kColumns));
      columns_seen = true;
      continue;
    }
    const auto numbers = parse(line);
    if (!numbers || !is_star(*numbers)) refuse(fmt::format("a star's {}", kColumns));
    if ((*numbers)[5] < faintest) refuse("stars in the order of their magnitude, brightest first");
    faintest = (*numbers)[5];
    sky.stars_.push_back(star_of(*numbers, zero_magnitude_photons));
  }
  if (faintest < kFaintest)
    throw std::runtime_error(
        fmt::format("{}:{}: the star catalogue ends at magnitude {}, accepted: 8.00; it is cut short", file.string(),
                    number, faintest));
  std::stable_sort(sky.stars_.begin(), sky.stars_.end(),
                   [](const SkyStar& a, const SkyStar& b) { return a.direction_j2000.z() < b.direction_j2000.z(); });
  return sky;
}

void StarSky::find(const Vector3& axis_eci, double half_angle, double years_since_j2000, const Vector3& velocity_bcrs,
                   std::vector<ApparentStar>& seen) const {
  // The catalogue's place and the apparent one differ by less: 26 arcsec of aberration, 10 arcsec a year of the
  // fastest.
  const double reach = half_angle + 0.001 + 5e-5 * std::abs(years_since_j2000);
  const double declination = std::asin(std::clamp(axis_eci.z(), -1.0, 1.0));
  const auto z_of = [](double angle) { return std::sin(std::clamp(angle, -M_PI / 2.0, M_PI / 2.0)); };
  const auto from = std::lower_bound(stars_.begin(), stars_.end(), z_of(declination - reach),
                                     [](const SkyStar& star, double z) { return star.direction_j2000.z() < z; });
  const double z_to = z_of(declination + reach);
  const double cosine = std::cos(std::min(reach, M_PI));
  for (auto star = from; star != stars_.end() && star->direction_j2000.z() <= z_to; ++star) {
    if (star->direction_j2000.dot(axis_eci) < cosine) continue;
    const Vector3 now = (star->direction_j2000 + years_since_j2000 * star->motion_per_year).normalized();
    seen.push_back({&*star, apparent_direction(now, velocity_bcrs)});
  }
}

}  // namespace vbar::twins::camera
