#include "hil_drivers/optical_stimulator/pictures/picture_maker.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hil_drivers/optical_stimulator/pictures/display_light.h"

namespace vbar::optical_stimulator {

namespace {

/// Returns the integral of a unit Gaussian over the pixel at that distance from its centre.
double pixel_integral(double distance, double sigma) {
  const double scale = 1.0 / (std::sqrt(2.0) * sigma);
  return 0.5 * (std::erf((distance + 0.5) * scale) - std::erf((distance - 0.5) * scale));
}

}  // namespace

bool draw_dot(const DisplayLight& light, const fsw::Vector2& centre, double sigma_px, double electrons,
              Picture& picture) {
  if (!centre.allFinite() || std::abs(centre.x()) > 1e6 || std::abs(centre.y()) > 1e6) return false;
  const int x = static_cast<int>(std::lround(centre.x())), y = static_cast<int>(std::lround(centre.y()));
  if (!picture.holds(x - kPatchReach, y - kPatchReach) || !picture.holds(x + kPatchReach, y + kPatchReach))
    return false;
  Patch<double> wanted;
  std::array<double, kPatchSide> columns, rows;
  for (int k = 0; k < kPatchSide; ++k) {
    columns[static_cast<std::size_t>(k)] = pixel_integral(x - kPatchReach + k - centre.x(), sigma_px);
    rows[static_cast<std::size_t>(k)] = pixel_integral(y - kPatchReach + k - centre.y(), sigma_px);
  }
  double across = 0.0, down = 0.0;  // all of the light is shown, the tails included
  for (const double part : columns) across += part;
  for (const double part : rows) down += part;
  for (std::size_t k = 0; k < wanted.size(); ++k)
    wanted[k] = electrons * columns[k % kPatchSide] * rows[k / kPatchSide] / (across * down);
  const auto counts = matched_counts(light, x, y, wanted);
  for (std::size_t k = 0; k < counts.size(); ++k)
    picture.at(x - kPatchReach + static_cast<int>(k % kPatchSide), y - kPatchReach + static_cast<int>(k / kPatchSide)) =
        counts[k];
  return true;
}

namespace {

using twins::camera::Region;

constexpr int kRing = 2;                // px about a patch, that hold little light beside a point
constexpr double kRingLight = 0.02;     // share of the light of the patch
constexpr double kLargestSquare = 9.0;  // px^2
constexpr int kWindow = kPatchReach + kRing;

}  // namespace

double PictureMaker::wanted_at(int x, int y) const {
  const Region& region = wanted_->region;
  const float electrons =
      wanted_->electrons[static_cast<std::size_t>(y - region.y) * static_cast<std::size_t>(region.width) +
                         static_cast<std::size_t>(x - region.x)];
  return electrons > 0.0F ? static_cast<double>(electrons) : 0.0;
}

PictureFigures PictureMaker::draw(const twins::camera::PhotonImage& wanted, Picture& picture) {
  const Region& region = wanted.region;
  if (picture.width != light_.width() || picture.height != light_.height())
    throw std::invalid_argument("the picture is not of the display's size");
  if (region.x < 0 || region.y < 0 || region.x + region.width > picture.width ||
      region.y + region.height > picture.height ||
      wanted.electrons.size() != static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height))
    throw std::invalid_argument("the light wanted does not lie on the display");
  wanted_ = &wanted;
  is_drawn_.assign(wanted.electrons.size(), 0);
  PictureFigures figures;
  find_points();
  for (const Point& point : points_) draw_point(point, picture, figures);
  draw_extended(picture, figures);
  wanted_ = nullptr;
  return figures;
}

bool PictureMaker::is_maximum(int x, int y) const {
  const double here = wanted_at(x, y);
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const double there = wanted_at(x + dx, y + dy);
      const bool is_before = dy < 0 || (dy == 0 && dx < 0);  // the first of equals counts
      if (there > here || (there == here && is_before)) return false;
    }
  return true;
}

/// Whether its patch holds nearly all light about it, above an even background.
bool PictureMaker::is_compact(Point& point) const {
  double inside = 0.0, window = 0.0, background = wanted_at(point.x, point.y);
  constexpr int kSide = 2 * kWindow + 1;
  for (int dy = -kWindow; dy <= kWindow; ++dy)
    for (int dx = -kWindow; dx <= kWindow; ++dx) {
      const double electrons = wanted_at(point.x + dx, point.y + dy);
      window += electrons;
      background = std::min(background, electrons);
      if (std::max(std::abs(dx), std::abs(dy)) <= kPatchReach) inside += electrons;
    }
  const double point_light = inside - background * kPatchSide * kPatchSide;
  const double ring_light = window - inside - background * (kSide * kSide - kPatchSide * kPatchSide);
  point.electrons = inside;
  return point_light > 0.0 && ring_light <= kRingLight * point_light;
}

void PictureMaker::find_points() {
  points_.clear();
  const Region& region = wanted_->region;
  for (int y = region.y + kWindow; y < region.y + region.height - kWindow; ++y)
    for (int x = region.x + kWindow; x < region.x + region.width - kWindow; ++x) {
      constexpr double kNoticed = 0.5;  // share of the faintest light
      if (wanted_at(x, y) < kNoticed * light_.least_fraction() * light_.full_electrons(x, y)) continue;
      Point point{x, y, 0.0};
      if (is_maximum(x, y) && is_compact(point)) points_.push_back(point);
    }
  std::ranges::stable_sort(points_, std::ranges::greater{}, &Point::electrons);
}

/// An even square about the centroid of the patch.
Patch<double> PictureMaker::square_about(const Point& point, const Patch<double>& wanted, double electrons) const {
  double flux = 0.0, x = 0.0, y = 0.0;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    flux += wanted[k];
    x += wanted[k] * (static_cast<double>(k % kPatchSide) - kPatchReach);
    y += wanted[k] * (static_cast<double>(k / kPatchSide) - kPatchReach);
  }
  x /= flux;
  y /= flux;
  const double half_side = 0.5 * std::sqrt(electrons / light_.full_electrons(point.x, point.y));
  const auto overlap = [half_side](double pixel, double centre) {
    return std::max(0.0, std::min(pixel + 0.5, centre + half_side) - std::max(pixel - 0.5, centre - half_side));
  };
  Patch<double> square;
  double shape = 0.0;
  for (std::size_t k = 0; k < square.size(); ++k) {
    square[k] = overlap(static_cast<double>(k % kPatchSide) - kPatchReach, x) *
                overlap(static_cast<double>(k / kPatchSide) - kPatchReach, y);
    shape += square[k];
  }
  for (double& part : square) part *= electrons / shape;
  return square;
}

void PictureMaker::draw_point(const Point& point, Picture& picture, PictureFigures& figures) {
  const Region& region = wanted_->region;
  Patch<double> wanted;
  double flux = 0.0, brightest = 0.0;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const int x = point.x - kPatchReach + static_cast<int>(k % kPatchSide);
    const int y = point.y - kPatchReach + static_cast<int>(k / kPatchSide);
    const auto place = static_cast<std::size_t>(y - region.y) * static_cast<std::size_t>(region.width) +
                       static_cast<std::size_t>(x - region.x);
    if (is_drawn_[place] != 0)
      return;  // a brighter point has one of its pixels: both are drawn, this one as extended light
    wanted[k] = wanted_at(x, y);
    flux += wanted[k];
    brightest = std::max(brightest, wanted[k] / light_.full_electrons(x, y));
  }
  ++figures.points;
  figures.wanted_electrons += flux;
  if (brightest > 1.0) {
    const double shown = std::min(flux, kLargestSquare * light_.full_electrons(point.x, point.y));
    wanted = square_about(point, wanted, shown);
    figures.clipped_electrons += flux - shown;
    if (flux > shown) ++figures.clipped_points;
  }
  const auto counts = matched_counts(light_, point.x, point.y, wanted);
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const int x = point.x - kPatchReach + static_cast<int>(k % kPatchSide);
    const int y = point.y - kPatchReach + static_cast<int>(k / kPatchSide);
    picture.at(x, y) = counts[k];
    is_drawn_[static_cast<std::size_t>(y - region.y) * static_cast<std::size_t>(region.width) +
              static_cast<std::size_t>(x - region.x)] = 1;
  }
}

void PictureMaker::draw_extended(Picture& picture, PictureFigures& figures) {
  const Region& region = wanted_->region;
  const auto width = static_cast<std::size_t>(region.width);
  errors_.assign(width + 2, 0.0F);  // electrons to be made up in this row, with a margin of one pixel
  for (int row = 0; row < region.height; ++row) {
    next_errors_.assign(width + 2, 0.0F);
    const int step = row % 2 == 0 ? 1 : -1;  // to and fro, so that no direction is preferred
    for (int k = 0; k < region.width; ++k) {
      const int column = step > 0 ? k : region.width - 1 - k;
      const int x = region.x + column, y = region.y + row;
      const auto place = static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column);
      if (is_drawn_[place] != 0) continue;
      const double full = light_.full_electrons(x, y);
      const double here = wanted_at(x, y);
      figures.wanted_electrons += here;
      const double clipped = std::max(0.0, here - full);
      figures.clipped_electrons += clipped;
      const auto at = static_cast<std::size_t>(column + 1);
      const double wanted = here - clipped + static_cast<double>(errors_[at]);
      const std::uint8_t count = light_.nearest_count(wanted / full);
      picture.at(x, y) = count;
      const auto error = static_cast<float>(wanted - full * light_.fraction(count));
      const auto ahead = static_cast<std::size_t>(column + 1 + step),
                 behind = static_cast<std::size_t>(column + 1 - step);
      errors_[ahead] += error * (7.0F / 16.0F);
      next_errors_[behind] += error * (3.0F / 16.0F);
      next_errors_[at] += error * (5.0F / 16.0F);
      next_errors_[ahead] += error * (1.0F / 16.0F);
    }
    std::swap(errors_, next_errors_);
  }
}

}  // namespace vbar::optical_stimulator
