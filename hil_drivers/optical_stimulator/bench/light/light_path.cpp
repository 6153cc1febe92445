#include "hil_drivers/optical_stimulator/bench/light/light_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "hil_drivers/optical_stimulator/bench/light/halo.h"

namespace vbar::optical_stimulator::bench {

using fsw::Vector2;
using twins::camera::PhotonImage;
using twins::camera::Region;

namespace {

constexpr int kCell_px = 16;
// A quarter of the light is displaced outwards, four times as far as the centroid.
constexpr float kComaFraction = 0.25F;
constexpr int kMaxWidth = 2 * 64 + 1;

std::size_t area_of(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

}  // namespace

LightPath::LightPath(const LightPathSettings& settings, const BenchOptics& optics)
    : settings_(settings),
      optics_(&optics),
      luminance_(luminance_table(settings.light)),
      evenness_(settings.light.pixel_unevenness, settings.seed),
      electrons_per_lux_s_(photons_per_lux(settings.camera.zero_magnitude_photons) *
                           settings.camera.electrons_per_photon_m2()),
      seen_(area_of(settings.display_width, settings.display_height)),
      cell_columns_((settings.display_width + kCell_px - 1) / kCell_px),
      cell_rows_((settings.display_height + kCell_px - 1) / kCell_px) {}

void LightPath::optics_changed() {
  ++version_;
}

const LightPath::Seen& LightPath::seen(std::size_t pixel, int u, int v) {
  Seen& seen = seen_[pixel];
  if (seen.version == version_) return seen;
  const SeenPixel exact = optics_->seen(u, v);
  seen.x = static_cast<float>(exact.pixel.x());
  seen.y = static_cast<float>(exact.pixel.y());
  const double displaced = 1.0 / static_cast<double>(kComaFraction);
  seen.coma_x = static_cast<float>(displaced * exact.coma_px.x());
  seen.coma_y = static_cast<float>(displaced * exact.coma_px.y());
  seen.electrons =
      static_cast<float>(electrons_per_lux_s_ * exact.solid_angle * exact.transmitted * evenness_.of(pixel));
  seen.profile = static_cast<std::uint32_t>(profiles_.index_of(exact.sigma_px));
  seen.version = version_;
  return seen;
}

void LightPath::expose(std::span<const ShownFrame> frames, double exposure_s, double brightness, PhotonImage& image) {
  const Region& region = image.region;
  image.electrons.assign(area_of(region.width, region.height), 0.0F);
  if (region != region_ || region_version_ != version_) {
    choose_cells(region);
    make_black_level(region);
    region_ = region;
    region_version_ = version_;
  }
  for (const ShownFrame& frame : frames)
    if (frame.fraction > 0.0) add_frame(frame, exposure_s * brightness * frame.fraction, image);
  add_halo(image);
  add_black_level(electrons_per_lux_s_ * exposure_s * brightness * settings_.light.black_luminance(), image);
}

void LightPath::add_frame(const ShownFrame& frame, double gain, PhotonImage& image) {
  const auto width = static_cast<std::size_t>(settings_.display_width);
  if (frame.counts.size() != seen_.size()) throw std::invalid_argument("a frame of another size than the display");
  CountTable table = luminance_;
  for (float& luminance : table) luminance *= static_cast<float>(gain);
  for (int row = 0; row < cell_rows_; ++row) {
    const int v_end = std::min(settings_.display_height, (row + 1) * kCell_px);
    for (int column = 0; column < cell_columns_; ++column) {
      if (cell_is_near_[static_cast<std::size_t>(row * cell_columns_ + column)] == 0) continue;
      const int u_begin = column * kCell_px, u_end = std::min(settings_.display_width, u_begin + kCell_px);
      for (int v = row * kCell_px; v < v_end; ++v) {
        const std::size_t first = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u_begin);
        const std::uint8_t* counts = &frame.counts[first];
        constexpr std::array<std::uint8_t, kCell_px> kBlack{};
        if (u_end - u_begin == kCell_px && std::memcmp(counts, kBlack.data(), kCell_px) == 0) continue;
        for (int u = u_begin; u < u_end; ++u) {
          const float light = table[counts[u - u_begin]];
          if (!(light > 0.0F)) continue;
          const Seen& place = seen(first + static_cast<std::size_t>(u - u_begin), u, v);
          add_pixel(place, light * place.electrons, image);
        }
      }
    }
  }
}

void LightPath::add_pixel(const Seen& seen, float electrons, PhotonImage& image) {
  const SpreadProfile& profile = profiles_.at(seen.profile);
  const int radius = profile.radius();
  const auto width = static_cast<std::size_t>(2 * radius + 1);
  const float x0 = std::floor(seen.x + 0.5F), y0 = std::floor(seen.y + 0.5F);
  const Region& region = image.region;
  if (!(std::abs(x0) < 1e6F && std::abs(y0) < 1e6F)) return;
  const int left = static_cast<int>(x0) - radius - region.x, top = static_cast<int>(y0) - radius - region.y;
  const int side = static_cast<int>(width);
  if (left + side <= 0 || top + side <= 0 || left >= region.width || top >= region.height) return;
  std::array<float, kMaxWidth> x, y, coma_x, coma_y;
  const double offset_x = static_cast<double>(seen.x - x0), offset_y = static_cast<double>(seen.y - y0);
  profile.weights(offset_x, std::span(x).first(width));
  profile.weights(offset_y, std::span(y).first(width));
  profile.weights(offset_x + static_cast<double>(seen.coma_x), std::span(coma_x).first(width));
  profile.weights(offset_y + static_cast<double>(seen.coma_y), std::span(coma_y).first(width));
  const int first_column = std::max(0, -left), last_column = std::min(side, region.width - left);
  const int first_row = std::max(0, -top), last_row = std::min(side, region.height - top);
  for (int row = first_row; row < last_row; ++row) {
    const float core = electrons * (1.0F - kComaFraction) * y[static_cast<std::size_t>(row)];
    const float coma = electrons * kComaFraction * coma_y[static_cast<std::size_t>(row)];
    float* pixels = &image.electrons[static_cast<std::size_t>(top + row) * static_cast<std::size_t>(region.width)];
    for (int column = first_column; column < last_column; ++column) {
      const auto k = static_cast<std::size_t>(column);
      pixels[left + column] += core * x[k] + coma * coma_x[k];
    }
  }
}

void LightPath::add_halo(PhotonImage& image) {
  const auto& optics = settings_.camera.optics;
  spread_halo(optics.halo_fraction, optics.halo_sigma_px, image, work_);
}

/// Cells of the display whose light may reach the region.
void LightPath::choose_cells(const Region& region) {
  cell_is_near_.assign(area_of(cell_columns_, cell_rows_), 0);
  for (int row = 0; row < cell_rows_; ++row) {
    for (int column = 0; column < cell_columns_; ++column) {
      const double u = kCell_px * (column + 0.5) - 0.5, v = kCell_px * (row + 0.5) - 0.5;
      const SeenPixel middle = optics_->seen(u, v);
      const double half_cell = (optics_->detector_pixel(u + 0.5 * kCell_px, v + 0.5 * kCell_px) - middle.pixel).norm();
      const double reach = 1.1 * half_cell + profiles_.at(profiles_.index_of(middle.sigma_px)).radius() + 2.0;
      const bool is_near = middle.pixel.x() > region.x - reach && middle.pixel.y() > region.y - reach &&
                           middle.pixel.x() < region.x + region.width + reach &&
                           middle.pixel.y() < region.y + region.height + reach;
      cell_is_near_[static_cast<std::size_t>(row * cell_columns_ + column)] = is_near ? 1 : 0;
    }
  }
}

/// On a grid of detector pixels that is interpolated; a pixel that does not see the display has no black level.
void LightPath::make_black_level(const Region& region) {
  struct Node {
    Vector2 place;
    double light;
  };
  const int columns = region.width / kCell_px + 2, rows = region.height / kCell_px + 2;
  std::vector<Node> nodes;
  nodes.reserve(area_of(columns, rows));
  const double pixel_angle = 1.0 / settings_.camera.focal_length_px();
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Vector2 pixel(region.x + kCell_px * column, region.y + kCell_px * row);
      const Vector2 place = optics_->display_pixel(pixel);
      const SeenPixel seen = optics_->seen(place.x(), place.y());
      nodes.push_back({place, pixel_angle * pixel_angle * seen.transmitted * optics_->light_at(place.x(), place.y())});
    }
  }
  black_.assign(area_of(region.width, region.height), 0.0F);
  const double u_max = settings_.display_width - 0.5, v_max = settings_.display_height - 0.5;
  std::size_t pixel = 0;
  for (int y = 0; y < region.height; ++y) {
    const double ty = static_cast<double>(y % kCell_px) / kCell_px;
    const Node* above = &nodes[static_cast<std::size_t>(y / kCell_px) * static_cast<std::size_t>(columns)];
    for (int x = 0; x < region.width; ++x, ++pixel) {
      const double tx = static_cast<double>(x % kCell_px) / kCell_px;
      const Node* a = above + x / kCell_px;
      const Node* b = a + columns;
      const auto mix = [&](double p, double q, double r, double s) {
        return (1.0 - ty) * ((1.0 - tx) * p + tx * q) + ty * ((1.0 - tx) * r + tx * s);
      };
      const double u = mix(a[0].place.x(), a[1].place.x(), b[0].place.x(), b[1].place.x());
      const double v = mix(a[0].place.y(), a[1].place.y(), b[0].place.y(), b[1].place.y());
      if (!(u >= -0.5 && v >= -0.5 && u <= u_max && v <= v_max)) continue;
      black_[pixel] = static_cast<float>(mix(a[0].light, a[1].light, b[0].light, b[1].light));
    }
  }
}

void LightPath::add_black_level(double electrons_per_unit, PhotonImage& image) {
  const auto gain = static_cast<float>(electrons_per_unit);
  for (std::size_t k = 0; k < black_.size(); ++k) image.electrons[k] += gain * black_[k];
}

}  // namespace vbar::optical_stimulator::bench
