#pragma once
// Times of a periodic event whose period changes at given times: flight steps, images.

#include <cstdint>
#include <optional>
#include <vector>

#include "fsw/core/gps_time.h"

namespace vbar::engine {

/// A part begins at its own time; its epochs are one period after that, two periods, and so on, up to and including the
/// beginning of the next part.
class Cadence {
 public:
  struct Part {
    fsw::GpsTime from;
    fsw::Duration period;  ///< > 0
    friend bool operator==(const Part&, const Part&) = default;
  };

  /// Throws std::invalid_argument without a part, and for parts that are not in order of time.
  explicit Cadence(std::vector<Part> parts);
  Cadence(fsw::GpsTime from, fsw::Duration period) : Cadence(std::vector<Part>{{from, period}}) {}

  /// The first epoch later than `time`.
  [[nodiscard]] fsw::GpsTime next_after(fsw::GpsTime time) const;
  /// The first epoch at `time` or later.
  [[nodiscard]] fsw::GpsTime next_at(fsw::GpsTime time) const { return next_after(time - fsw::Duration{1}); }
  /// The number of epochs before `time`: the first epoch has number 0.
  [[nodiscard]] std::int64_t number_of(fsw::GpsTime time) const;

  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  [[nodiscard]] fsw::Duration shortest_period() const;

  friend bool operator==(const Cadence&, const Cadence&) = default;

 private:
  std::vector<Part> parts_;
};

}  // namespace vbar::engine
