#pragma once
// Receiver of the object stream of Vicon Tracker on a UDP port of this computer.

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "hil_drivers/tron/geometry/testbed_design.h"
#include "hil_drivers/tron/protocols/vicon_stream.h"

namespace vbar::tron::vicon {

// The pose of an object of motion capture, averaged over frames at rest.

enum class ObjectState {
  kTracked,
  kSilent,    ///< too few frames
  kMissing,   ///< not in the frames
  kOccluded,  ///< all numbers are zero
  kFrozen,    ///< the numbers are those of the average before, although the object has moved since
};

struct ObjectAverage {
  ObjectState state = ObjectState::kSilent;
  int frames = 0;  ///< averaged
  Eigen::Isometry3d T_V_object = Eigen::Isometry3d::Identity();
  // Scatter of one frame about the mean, root mean square of the three axes.
  double translation_scatter_m = 0.0, rotation_scatter_rad = 0.0;
};

/// Returns mean translation and mean rotation (the one for which the rotation vectors to all others sum to zero), state
/// kTracked; without poses: kSilent.
[[nodiscard]] ObjectAverage average_of(const std::vector<Eigen::Isometry3d>& poses);

// Source of poses of motion capture. The driver runs robot cycles and then drains what has arrived, so that bench
// time decides how much that is; it waits in wall clock for frames that do not depend on its cycles.

/// States which objects have moved since the average before.
struct Moved {
  bool camera = true, target = true;
};

struct CaptureAverage {
  ObjectAverage camera, target;
  [[nodiscard]] bool is_tracked() const {
    return camera.state == ObjectState::kTracked && target.state == ObjectState::kTracked;
  }
};

struct CaptureCounts {
  std::uint64_t frames = 0;
  std::uint64_t frames_lost = 0;                                    ///< gaps of the frame numbers
  std::uint64_t late_blocks = 0;                                    ///< blocks of a frame before the last one; ignored
  std::uint64_t restarts = 0;                                       ///< restarts of the frame numbers
  std::uint64_t unreadable = 0;                                     ///< datagrams
  std::uint64_t silent = 0, missing = 0, occluded = 0, frozen = 0;  ///< averages of an object
  std::string last_unreadable;                                      ///< why
};

class CaptureSource {
 public:
  CaptureSource() = default;
  CaptureSource(const CaptureSource&) = delete;
  CaptureSource& operator=(const CaptureSource&) = delete;
  virtual ~CaptureSource() = default;

  /// Takes and discards what has arrived: frames after this call belong to the objects at rest.
  virtual void clear() = 0;
  /// Takes what has arrived, without waiting; returns the frames since clear(). Throws std::runtime_error.
  virtual int drain() = 0;
  /// Calls drain() until there are `frames` since clear(), at most for `timeout` of wall clock.
  virtual int wait_for(int frames, std::chrono::milliseconds timeout) = 0;

  /// Returns the average of the last `frames` since clear(). An object is tracked if it was in at least half of that
  /// number.
  [[nodiscard]] virtual CaptureAverage average(int frames, const Moved& moved) = 0;

  [[nodiscard]] virtual CaptureCounts counts() const = 0;
  /// Returns the name for messages: "Vicon at UDP port 51001".
  [[nodiscard]] virtual std::string description() const = 0;
};

// Frames of the object stream since the last clear(), put together from their blocks.

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

class Receiver final : public CaptureSource {
 public:
  /// Listens on `settings.port` (0: any free one) of `address`. `rotation`: order of the angles, as the calibration
  /// found it; empty: as in the settings. Throws std::runtime_error, std::invalid_argument.
  explicit Receiver(const ViconSettings& settings, const std::string& rotation = {},
                    const std::string& address = "0.0.0.0");
  ~Receiver() override;

  [[nodiscard]] std::uint16_t port() const;

  void clear() override;
  int drain() override;
  int wait_for(int frames, std::chrono::milliseconds timeout) override;
  [[nodiscard]] CaptureAverage average(int frames, const Moved& moved) override;
  [[nodiscard]] CaptureCounts counts() const override;
  [[nodiscard]] std::string description() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vbar::tron::vicon
