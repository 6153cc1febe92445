#pragma once
// Object stream of the emulator: frames at the rate of motion capture in bench time, with errors and faults.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <boost/asio/io_context.hpp>

#include "hil_drivers/tron/bench/vicon/capture_errors.h"
#include "hil_drivers/tron/bench_file/bench_file.h"

namespace vbar::tron::bench {

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
