#include "hil_drivers/optical_stimulator/bench/light/spread_profile.h"

#include <algorithm>
#include <cmath>

#include "host_sim/engine/distributions.h"

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

}  // namespace vbar::optical_stimulator::bench
