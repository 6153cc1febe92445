#pragma once
// Features of the emulated camera, listed once: from this table come registers, limits and the GenICam description.

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace vbar::gige {

// Identity that the emulated camera states.

/// Describes the camera; defaults are those of the Optical Stimulator's camera.
struct Description {
  std::string manufacturer = "Point Grey Research";
  std::string model = "Grasshopper3 GS3-PGE-23S6M";
  std::string version = "emulated";
  std::string manufacturer_info =
      "emulated GigE Vision device of vbar";  ///< names the emulation, at most 47 characters
  std::string serial = "00000001";
  int sensor_width = 1920, sensor_height = 1200;
  int converter_bits = 12;  ///< 8 to 16, left-aligned in Mono16
};

/// Names the features in the order of the table.
enum class FeatureId : std::size_t {
  kSensorWidth,
  kSensorHeight,
  kWidthMax,
  kHeightMax,
  kOffsetXMax,
  kOffsetYMax,
  kWidth,
  kHeight,
  kOffsetX,
  kOffsetY,
  kPixelFormat,
  kPayloadSize,
  kAcquisitionMode,
  kAcquisitionStart,
  kAcquisitionStop,
  kFrameRateAuto,
  kFrameRateEnabled,
  kFrameRate,
  kTriggerSelector,
  kTriggerMode,
  kTriggerSource,
  kTriggerSoftware,
  kExposureMode,
  kExposureAuto,
  kExposureTime,
  kGainAuto,
  kGain,
  kBlackLevel,
  kGammaEnabled,
  kGamma,
  kSharpnessEnabled,
};

enum class FeatureKind { kInteger, kFloat, kEnumeration, kBoolean, kCommand };
enum class FeatureAccess { kReadOnly, kReadWrite, kWriteOnly };

struct Feature {
  FeatureId id;
  std::string_view name, category;
  FeatureKind kind;
  FeatureAccess access;
  double initial = 0.0;
  // Range of integers and floats.
  double min = 0.0, max = 0.0, increment = 1.0;
  std::string_view max_feature = "";  ///< has the limit in the place of `max`
  std::string_view unit = "";
  std::vector<std::pair<std::string_view, std::uint32_t>> entries = {};  ///< names and values of an enumeration
  bool locked_in_acquisition = false;

  [[nodiscard]] std::uint32_t address() const { return 0x10000U + 8U * static_cast<std::uint32_t>(id); }
  /// Returns the size of the register; a float is IEEE 754 double.
  [[nodiscard]] std::uint32_t size() const { return kind == FeatureKind::kFloat ? 8 : 4; }
};

[[nodiscard]] std::vector<Feature> features_of(const Description& description);

// GenICam description (GenApi 1.1 schema) of the emulated camera.

[[nodiscard]] std::string genicam_xml(const Description& description, const std::vector<Feature>& features);

}  // namespace vbar::gige
