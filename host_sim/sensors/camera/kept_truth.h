#pragma once
// The truth at each image's exposure, kept until the flight software has reported on that image.

#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include "host_sim/twins/packet_source.h"

namespace vbar::sensors {

class KeptTruth {
 public:
  /// Keeps the truth of an exposure, once for each image: two cameras may expose at the same time.
  void keep(const twins::TruthSnapshot& truth) { kept_.emplace(truth.time, truth); }

  /// Returns the truth of an exposure and releases it. If there is none, the exposure is counted and the result empty.
  std::optional<twins::TruthSnapshot> take(fsw::GpsTime exposure) {
    auto node = kept_.extract(exposure);
    if (node) return std::move(node.mapped());
    ++without_truth_;
    return std::nullopt;
  }

  /// Returns the number of images whose truth was asked for and missing.
  [[nodiscard]] int without_truth() const { return without_truth_; }
  [[nodiscard]] std::size_t size() const { return kept_.size(); }

 private:
  std::multimap<fsw::GpsTime, twins::TruthSnapshot> kept_;
  int without_truth_ = 0;
};

}  // namespace vbar::sensors
