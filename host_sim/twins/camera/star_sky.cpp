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

#include "fsw/core/types.h"
#include "host_sim/files/data_stream.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/twins/camera/photometry.h"

namespace vbar::twins::camera {

namespace {

using fsw::Vector3;

/// The rows of a file, and refusals that name them.
class Rows {
 public:
  explicit Rows(const std::filesystem::path& file) : file_(file), in_(file) {
    if (!in_) throw std::runtime_error(fmt::format("{}: cannot open the star catalogue", file.string()));
  }

  /// Reads the next row; lines that begin with '#' are skipped.
  bool next() {
    while (std::getline(in_, row_)) {
      ++number_;
      if (in_.eof()) refuse("a line that ends: the star catalogue is cut short");
      if (row_.ends_with('\r')) row_.pop_back();
      if (!row_.starts_with('#')) return true;
    }
    return false;
  }
  [[nodiscard]] const std::string& row() const { return row_; }
  [[noreturn]] void refuse(std::string_view accepted) const {
    throw std::runtime_error(
        fmt::format("{}:{}: found {}, accepted: {}", file_.string(), number_, files::quoted(row_), accepted));
  }
  [[noreturn]] void refuse_end(std::string_view reason) const {
    throw std::runtime_error(fmt::format("{}:{}: {}", file_.string(), number_, reason));
  }

 private:
  std::filesystem::path file_;
  files::DataStream in_;
  std::string row_;
  int number_ = 0;
};

bool is_star(const CatalogueStar& star) {
  return star.hip >= 0 && star.ra_deg >= 0.0 && star.ra_deg < 360.0 && std::abs(star.dec_deg) <= 90.0 &&
         std::abs(star.pm_ra_mas) < 2e4 && std::abs(star.pm_dec_mas) < 2e4 && star.v > -2.0 && star.v < 20.0 &&
         std::abs(star.b_v) < 10.0;
}

namespace own_table {

constexpr std::string_view kColumns = "hip,ra_deg,dec_deg,pm_ra_mas,pm_dec_mas,v,b_v";
constexpr std::size_t kNumbers = 7;
constexpr double kFaintest = 7.995;  // minimum magnitude of the file's last star

std::optional<CatalogueStar> parse(std::string_view row) {
  std::array<double, kNumbers> n;
  const char* at = row.data();
  const char* const end = at + row.size();
  for (std::size_t column = 0; column < kNumbers; ++column) {
    const auto [next, error] = std::from_chars(at, end, n[column]);
    if (error != std::errc{} || !std::isfinite(n[column])) return std::nullopt;
    at = next;
    if (column + 1 < kNumbers && (at == end || *at++ != ',')) return std::nullopt;
  }
  if (at != end || n[0] != std::floor(n[0]) || std::abs(n[0]) > 1e6) return std::nullopt;
  return CatalogueStar{static_cast<int>(n[0]), n[1], n[2], n[3], n[4], n[5], n[6]};
}

std::vector<CatalogueStar> read(Rows& rows) {
  if (rows.row() != kColumns) rows.refuse(fmt::format("the columns {}, or a row of hip_main.dat", kColumns));
  std::vector<CatalogueStar> stars;
  double faintest = -10.0;
  while (rows.next()) {
    const auto star = parse(rows.row());
    if (!star || !is_star(*star)) rows.refuse(fmt::format("a star's {}", kColumns));
    if (star->v < faintest) rows.refuse("stars in the order of their magnitude, brightest first");
    faintest = star->v;
    stars.push_back(*star);
  }
  if (faintest < kFaintest)
    rows.refuse_end(fmt::format("the star catalogue ends at magnitude {}, accepted: 8.00; it is cut short", faintest));
  return stars;
}

}  // namespace own_table

namespace hipparcos_main {

// Numbers of the fields are those of the catalogue's description, H0 to H77.
constexpr std::size_t kFields = 78;
enum Field : std::size_t { kHip = 1, kV = 5, kRa = 8, kDec = 9, kPmRa = 12, kPmDec = 13, kBv = 37 };
constexpr double kYearsToJ2000 = 2000.0 - 1991.25;
constexpr double kUnknownColour = 0.6;
// The catalogue has some 41,000 stars to V 8, in order of right ascension: a file with fewer ends within it.
constexpr std::size_t kStarsToV8 = 40000;
constexpr std::string_view kAccepted = "78 fields separated by \"|\" as in hip_main.dat of CDS I/239";

/// Nothing for a blank field.
std::optional<double> number_in(const Rows& rows, std::string_view field) {
  const std::size_t first = field.find_first_not_of(' ');
  if (first == std::string_view::npos) return std::nullopt;
  std::string_view text = field.substr(first, field.find_last_not_of(' ') - first + 1);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) rows.refuse(kAccepted);
  return value;
}

std::array<std::string_view, kFields> fields_of(const Rows& rows) {
  std::array<std::string_view, kFields> fields;
  std::string_view rest = rows.row();
  for (std::size_t k = 0; k < kFields; ++k) {
    const std::size_t bar = rest.find('|');
    if ((bar == std::string_view::npos) != (k + 1 == kFields)) rows.refuse(kAccepted);
    fields[k] = rest.substr(0, bar);
    if (bar != std::string_view::npos) rest.remove_prefix(bar + 1);
  }
  if (fields[0] != "H") rows.refuse(kAccepted);
  return fields;
}

void move_to_j2000(CatalogueStar& star) {
  const double ra = star.ra_deg * kRadPerDegree, dec = star.dec_deg * kRadPerDegree;
  const Vector3 east(-std::sin(ra), std::cos(ra), 0.0);
  const Vector3 north(-std::sin(dec) * std::cos(ra), -std::sin(dec) * std::sin(ra), std::cos(dec));
  const Vector3 place(std::cos(dec) * std::cos(ra), std::cos(dec) * std::sin(ra), std::sin(dec));
  const Vector3 moved =
      place + kYearsToJ2000 * kRadPerMilliarcsecond * (star.pm_ra_mas * east + star.pm_dec_mas * north);
  const double ra_now = std::atan2(moved.y(), moved.x()) / kRadPerDegree;
  star.ra_deg = ra_now < 0.0 ? ra_now + 360.0 : ra_now;
  if (star.ra_deg >= 360.0) star.ra_deg = 0.0;  // right ascension of a place just west of the equinox
  star.dec_deg = std::atan2(moved.z(), std::hypot(moved.x(), moved.y())) / kRadPerDegree;
}

/// Nothing for an entry without place or magnitude.
std::optional<CatalogueStar> star_in(const Rows& rows) {
  const auto fields = fields_of(rows);
  const auto hip = number_in(rows, fields[kHip]);
  const auto v = number_in(rows, fields[kV]), ra = number_in(rows, fields[kRa]), dec = number_in(rows, fields[kDec]);
  const auto pm_ra = number_in(rows, fields[kPmRa]), pm_dec = number_in(rows, fields[kPmDec]);
  const auto b_v = number_in(rows, fields[kBv]);
  if (!hip || *hip < 1.0 || *hip > 1e6 || *hip != std::floor(*hip)) rows.refuse(kAccepted);
  if (!v || !ra || !dec || !pm_ra || !pm_dec) return std::nullopt;
  CatalogueStar star{static_cast<int>(*hip), *ra, *dec, *pm_ra, *pm_dec, *v, b_v.value_or(kUnknownColour)};
  if (!is_star(star)) rows.refuse("a star's position, proper motion, V and B-V in the units of hip_main.dat");
  move_to_j2000(star);
  return star;
}

std::vector<CatalogueStar> read(Rows& rows) {
  std::vector<CatalogueStar> stars;
  do {
    if (const auto star = star_in(rows)) stars.push_back(*star);
  } while (rows.next());
  const auto bright = std::ranges::count_if(stars, [](const CatalogueStar& star) { return star.v <= 8.0; });
  if (static_cast<std::size_t>(bright) < kStarsToV8)
    rows.refuse_end(fmt::format(
        "the star catalogue has {} stars to magnitude 8, accepted: {} and more; it is cut short", bright, kStarsToV8));
  return stars;
}

}  // namespace hipparcos_main

}  // namespace

std::vector<CatalogueStar> read_star_catalogue(const std::filesystem::path& file) {
  Rows rows(file);
  if (!rows.next()) rows.refuse_end("no row: the star catalogue is cut short");
  return rows.row().starts_with("H|") ? hipparcos_main::read(rows) : own_table::read(rows);
}

namespace {

SkyStar sky_star_of(const CatalogueStar& entry, double zero_magnitude_photons) {
  const double ra = entry.ra_deg * kRadPerDegree, dec = entry.dec_deg * kRadPerDegree;
  SkyStar star;
  star.hip = entry.hip;
  star.direction_j2000 = Vector3(std::cos(dec) * std::cos(ra), std::cos(dec) * std::sin(ra), std::sin(dec));
  const Vector3 east(-std::sin(ra), std::cos(ra), 0.0);
  const Vector3 north = star.direction_j2000.cross(east);
  star.motion_per_year = kRadPerMilliarcsecond * (entry.pm_ra_mas * east + entry.pm_dec_mas * north);
  star.v = entry.v;
  star.b_v = entry.b_v;
  star.photons_per_m2_s = star_photons(zero_magnitude_photons, star.v, star.b_v);
  return star;
}

}  // namespace

StarSky StarSky::load(const std::filesystem::path& file, double zero_magnitude_photons) {
  StarSky sky;
  for (const CatalogueStar& entry : read_star_catalogue(file))
    sky.stars_.push_back(sky_star_of(entry, zero_magnitude_photons));
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
