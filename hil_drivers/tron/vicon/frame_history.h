#pragma once
// Frames of the object stream since the last clear(), put together from their blocks.

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "hil_drivers/tron/vicon/capture_source.h"
#include "hil_drivers/tron/vicon/wire/object_stream.h"

namespace vbar::tron::vicon {

class FrameHistory {
 public:
  FrameHistory(std::string camera_object, std::string target_object, std::string rotation);

  void add(const ObjectBlock& block);
  void add_unreadable(const std::string& why);
  void clear() { frames_.clear(); }

  [[nodiscard]] int frames() const { return static_cast<int>(frames_.size()); }
  [[nodiscard]] CaptureAverage average(int frames, const Moved& moved);
  [[nodiscard]] const CaptureCounts& counts() const { return counts_; }

 private:
  enum Object : std::size_t { kCamera = 0, kTarget = 1 };
  using Frame = std::array<std::optional<TrackedObject>, 2>;

  bool begins_frame(std::uint32_t number);
  ObjectAverage average_of_object(Object object, std::size_t frames, bool has_moved);
  [[nodiscard]] ObjectState state_of(Object object, std::size_t first, std::size_t frames, bool has_moved) const;
  void count(ObjectState state);

  std::array<std::string, 2> names_;
  std::string rotation_;
  std::deque<Frame> frames_;
  std::optional<std::uint32_t> last_number_;
  std::array<std::optional<TrackedObject>, 2> averaged_last_;  ///< the last one of the average before
  CaptureCounts counts_;
};

}  // namespace vbar::tron::vicon
