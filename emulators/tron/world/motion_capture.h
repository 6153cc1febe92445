#pragma once
// Object stream of the emulator: frames at the rate of motion capture in bench time, with errors and faults.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <boost/asio/io_context.hpp>

#include "fsw/core/types.h"
#include "hil_drivers/tron/geometry/testbed_design.h"

namespace vbar::tron::bench {

// Random vector field of zero mean over places and directions: the bias of motion capture, the same whenever an
// object returns to a pose, and different elsewhere.

/// Sums plane waves of random phase, whose wave vectors are normal: its covariance falls with distance as a Gaussian
/// (Rahimi and Recht 2007, "Random features for large-scale kernel machines").
class BiasField {
 public:
  using Place = Eigen::Matrix<double, 9, 1>;

  /// Draws the field. `sigma`: standard deviation of each component. `length`: of the correlation along each component
  /// of a place; infinite: the field does not depend on it.
  BiasField(std::uint64_t seed, const std::string& stream, double sigma, const Place& length);

  [[nodiscard]] fsw::Vector3 at(const Place& place) const;

 private:
  static constexpr std::size_t kWaves = 48;  ///< number of waves of each component
  struct PlaneWave {
    Place wave_vector = Place::Zero();
    double phase = 0.0;
  };
  double amplitude_;
  std::array<std::array<PlaneWave, kWaves>, 3> waves_;
};

// Poses that the emulator's motion capture states for an object whose true pose is known: its frame V, the object's own
// axes, bias and noise. All are functions of the seed, the pose and the frame number; neither driver nor calibration
// reads any of them.

enum class CaptureObject : std::size_t { kCamera = 0, kTarget = 1 };
inline constexpr std::size_t kCaptureObjects = 2;

/// Holds one standard deviation of each error; defaults are those of data/benches/tron_emulated.toml.
struct CaptureErrorSizes {
  double frame_rotation_deg = 2.0;  ///< rotation of V from the laboratory's frame, each axis
  double frame_translation_mm = 50.0;
  double object_translation_mm = 50.0;  ///< origin of an object from that of the camera, of the target; axes: any
  double bias_mm = 0.3;                 ///< each axis, at any place
  double bias_length_m = 1.0;           ///< over which it varies
  double view_rotation_deg = 0.09;      ///< each axis; of an object at a place in an attitude
  double view_length_m = 0.3;           ///< over which that varies
  double view_length_deg = 20.0;        ///< ... of attitude
  double noise_mm = 0.05;               ///< noise of a frame, each axis
  double noise_deg = 0.02;

  /// Returns sizes without errors: the frame and the objects' axes are those of the laboratory, of camera and target.
  [[nodiscard]] static CaptureErrorSizes none();
};

/// Describes a key of the table [vicon] of the emulator.
struct CaptureErrorKey {
  std::string_view key;
  double CaptureErrorSizes::*size;
  double smallest, largest;
};

inline constexpr std::array<CaptureErrorKey, 10> kCaptureErrorKeys{{
    {"frame_rotation_deg", &CaptureErrorSizes::frame_rotation_deg, 0.0, 90.0},
    {"frame_translation_mm", &CaptureErrorSizes::frame_translation_mm, 0.0, 5000.0},
    {"object_translation_mm", &CaptureErrorSizes::object_translation_mm, 0.0, 500.0},
    {"bias_mm", &CaptureErrorSizes::bias_mm, 0.0, 100.0},
    {"bias_length_m", &CaptureErrorSizes::bias_length_m, 0.01, 100.0},
    {"view_rotation_deg", &CaptureErrorSizes::view_rotation_deg, 0.0, 10.0},
    {"view_length_m", &CaptureErrorSizes::view_length_m, 0.01, 100.0},
    {"view_length_deg", &CaptureErrorSizes::view_length_deg, 1.0, 1000.0},
    {"noise_mm", &CaptureErrorSizes::noise_mm, 0.0, 100.0},
    {"noise_deg", &CaptureErrorSizes::noise_deg, 0.0, 10.0},
}};

class CaptureErrors {
 public:
  CaptureErrors(const CaptureErrorSizes& sizes, std::uint64_t seed);

  /// Returns the pose of the object in V as frame number `frame` states it; `T_L_body`: true pose of the camera or the
  /// target.
  [[nodiscard]] Eigen::Isometry3d stated(CaptureObject object, const Eigen::Isometry3d& T_L_body,
                                         std::uint64_t frame) const;

  // Returns the true frame, for evaluations of the emulator.
  [[nodiscard]] const Eigen::Isometry3d& T_V_L() const { return T_V_L_; }
  [[nodiscard]] const Eigen::Isometry3d& T_body_object(CaptureObject object) const {
    return T_body_object_[static_cast<std::size_t>(object)];
  }

 private:
  CaptureErrorSizes sizes_;
  std::uint64_t seed_;
  Eigen::Isometry3d T_V_L_;
  std::array<Eigen::Isometry3d, kCaptureObjects> T_body_object_;
  BiasField place_bias_m_;
  std::array<BiasField, kCaptureObjects> view_bias_rad_;
};

struct ObjectStreamSettings {
  std::string address = "127.0.0.1";  ///< address of the driver's computer
  ViconSettings vicon;                ///< port of the computer, names, rate, order of the angles
  std::size_t block_bytes = 1024;     ///< see vicon::kBlockBytes
  std::uint32_t first_frame = 1;      ///< number of the first frame
};

class ObjectStreamSender {
 public:
  /// Returns the true pose of camera or target in L; nothing while the cameras cannot track it.
  using TruePose = std::function<std::optional<Eigen::Isometry3d>(CaptureObject)>;

  /// Throws std::runtime_error, std::invalid_argument.
  ObjectStreamSender(boost::asio::io_context& context, const ObjectStreamSettings& settings,
                     const CaptureErrors& errors, TruePose true_pose);
  ~ObjectStreamSender();
  ObjectStreamSender(const ObjectStreamSender&) = delete;
  ObjectStreamSender& operator=(const ObjectStreamSender&) = delete;

  /// Sends the frames that are due until `bench_s`, all of the poses now, and returns their number. A listener is not
  /// needed.
  int tick(double bench_s);

  // Set faults, until they are reset.
  void set_hidden(CaptureObject object, bool is_hidden);   ///< not in the frames
  void set_zeros(CaptureObject object, bool is_zero);      ///< as if occluded
  void set_frozen(CaptureObject object, bool is_frozen);   ///< keeps its numbers
  void set_offset(CaptureObject object, double offset_m);  ///< displaced along x of V

  [[nodiscard]] std::uint64_t frames() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vbar::tron::bench
