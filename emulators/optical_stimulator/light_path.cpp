#include "emulators/optical_stimulator/light_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <stdexcept>

#include "host_sim/engine/random_stream.h"

namespace vbar::optical_stimulator::bench {

namespace {

constexpr int kNodesPerPixel = 64;
constexpr double kReachSigmas = 4.2;

}  // namespace

SpreadProfile::SpreadProfile(double sigma_px)
    : radius_(std::max(4, static_cast<int>(std::ceil(kReachSigmas * sigma_px)))),
      stride_(static_cast<std::size_t>(2 * radius_ + 1)) {
  // Nodes from -1 to 1. What is beyond the reach is given to the other pixels, and the two next to the edge correct
  // the centroid: between nodes, interpolation keeps both.
  for (int node = -kNodesPerPixel; node <= kNodesPerPixel; ++node) {
    const double place = static_cast<double>(node) / kNodesPerPixel;
    std::vector<double> row(stride_);
    double sum = 0.0, moment = 0.0;
    for (std::size_t k = 0; k < stride_; ++k) {
      const double x = static_cast<double>(k) - radius_ - place;
      row[k] = engine::normal_distribution((x + 0.5) / sigma_px) - engine::normal_distribution((x - 0.5) / sigma_px);
      sum += row[k];
    }
    for (std::size_t k = 0; k < stride_; ++k) moment += (static_cast<double>(k) - radius_) * (row[k] /= sum);
    const auto middle = static_cast<std::size_t>(radius_);
    const double miss = 0.5 * (place - moment);
    row[middle + 1] += miss;
    row[middle - 1] -= miss;
    for (const double weight : row) table_.push_back(static_cast<float>(weight));
  }
}

void SpreadProfile::weights(double offset, std::span<float> weights) const {
  const double place = (std::clamp(offset, -1.0, 0.999) + 1.0) * kNodesPerPixel;
  const auto node = static_cast<std::size_t>(place);
  const auto t = static_cast<float>(place - static_cast<double>(node));
  const float* low = &table_[node * stride_];
  const float* high = low + stride_;
  for (std::size_t k = 0; k < stride_; ++k) weights[k] = low[k] + t * (high[k] - low[k]);
}

SpreadProfiles::SpreadProfiles() : known_(static_cast<std::size_t>(kWidest_px / kStep_px) + 1, nullptr) {}

std::size_t SpreadProfiles::index_of(double sigma_px) const {
  const double place = std::clamp(sigma_px, 0.1, kWidest_px) / kStep_px;
  return std::min(static_cast<std::size_t>(place + 0.5), known_.size() - 1);
}

const SpreadProfile& SpreadProfiles::at(std::size_t index) {
  if (known_[index] == nullptr) known_[index] = &profiles_.emplace_back(static_cast<double>(index) * kStep_px);
  return *known_[index];
}

namespace {

constexpr std::size_t kBin = 4;

std::vector<float> kernel_of(double sigma) {
  const int reach = std::max(1, static_cast<int>(std::ceil(4.0 * sigma)));
  std::vector<float> kernel;
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) sum += std::exp(-0.5 * k * k / (sigma * sigma));
  for (int k = -reach; k <= reach; ++k)
    kernel.push_back(static_cast<float>(std::exp(-0.5 * k * k / (sigma * sigma)) / sum));
  return kernel;
}

/// Along one direction of a grid: `count` places `step` apart.
void smooth_line(std::span<const float> kernel, const float* from, float* to, std::size_t count, std::size_t step) {
  const std::size_t reach = kernel.size() / 2;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first = k > reach ? k - reach : 0, last = std::min(count - 1, k + reach);
    float sum = 0.0F;
    for (std::size_t j = first; j <= last; ++j) sum += kernel[j + reach - k] * from[j * step];
    to[k * step] = sum;
  }
}

}  // namespace

void spread_halo(double fraction, double sigma_px, twins::camera::PhotonImage& image, std::vector<float>& work) {
  if (!(fraction > 0.0) || image.electrons.empty()) return;
  const auto width = static_cast<std::size_t>(image.region.width);
  const auto height = static_cast<std::size_t>(image.region.height);
  const std::size_t columns = (width + kBin - 1) / kBin, rows = (height + kBin - 1) / kBin;
  work.assign(2 * columns * rows, 0.0F);
  float* sums = work.data();
  float* smoothed = sums + columns * rows;
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) sums[y / kBin * columns + x / kBin] += image.electrons[y * width + x];
  // Summing over 4 pixels widens by (4^2 - 1)/12 and linear interpolation by 4^2/6.
  const double variance = std::max(0.25, sigma_px * sigma_px - 15.0 / 12.0 - 16.0 / 6.0);
  const std::vector<float> kernel = kernel_of(std::sqrt(variance) / kBin);
  for (std::size_t row = 0; row < rows; ++row)
    smooth_line(kernel, sums + row * columns, smoothed + row * columns, columns, 1);
  for (std::size_t column = 0; column < columns; ++column)
    smooth_line(kernel, smoothed + column, sums + column, rows, columns);

  const auto kept = static_cast<float>(1.0 - fraction);
  const auto gain = static_cast<float>(fraction / (kBin * kBin));
  constexpr float kFirst = 0.5F / kBin - 0.5F;  // place of a block's first pixel between the blocks' centres
  const auto neighbours = [](std::size_t pixel, std::size_t count, std::size_t& low, std::size_t& high) {
    const float place = std::clamp(kFirst + static_cast<float>(pixel) / kBin, 0.0F, static_cast<float>(count - 1));
    low = static_cast<std::size_t>(place);
    high = std::min(low + 1, count - 1);
    return place - static_cast<float>(low);
  };
  for (std::size_t y = 0; y < height; ++y) {
    std::size_t above = 0, below = 0;
    const float ty = neighbours(y, rows, above, below);
    for (std::size_t x = 0; x < width; ++x) {
      std::size_t left = 0, right = 0;
      const float tx = neighbours(x, columns, left, right);
      const float a =
          sums[above * columns + left] + tx * (sums[above * columns + right] - sums[above * columns + left]);
      const float b =
          sums[below * columns + left] + tx * (sums[below * columns + right] - sums[below * columns + left]);
      float& electrons = image.electrons[y * width + x];
      electrons = kept * electrons + gain * (a + ty * (b - a));
    }
  }
}

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
