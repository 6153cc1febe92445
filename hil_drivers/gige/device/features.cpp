#include "hil_drivers/gige/device/features.h"

#include "hil_drivers/gige/wire/pixels.h"

namespace vbar::gige {
namespace {

using enum FeatureKind;
using enum FeatureAccess;
using Entries = std::vector<std::pair<std::string_view, std::uint32_t>>;

// A region is placed and sized in steps of two pixels.
constexpr double kStep = 2.0;
constexpr double kMinSide = 16.0;

const Entries kAuto = {{"Off", 0}, {"Once", 1}, {"Continuous", 2}};
const Entries kOffOn = {{"Off", 0}, {"On", 1}};
constexpr double kContinuous = 2.0;

Feature integer(FeatureId id, std::string_view name, double initial, double min, double max, std::string_view max_of) {
  return {.id = id,
          .name = name,
          .category = "ImageFormatControl",
          .kind = kInteger,
          .access = kReadWrite,
          .initial = initial,
          .min = min,
          .max = max,
          .increment = kStep,
          .max_feature = max_of};
}

Feature read_only(FeatureId id, std::string_view name, double initial) {
  return {.id = id,
          .name = name,
          .category = "ImageFormatControl",
          .kind = kInteger,
          .access = kReadOnly,
          .initial = initial,
          .max = 4294967295.0};
}

Feature real(FeatureId id, std::string_view name, std::string_view category, std::string_view unit, double initial,
             double min, double max) {
  return {.id = id,
          .name = name,
          .category = category,
          .kind = kFloat,
          .access = kReadWrite,
          .initial = initial,
          .min = min,
          .max = max,
          .unit = unit};
}

Feature choice(FeatureId id, std::string_view name, std::string_view category, Entries entries, double initial) {
  return {.id = id,
          .name = name,
          .category = category,
          .kind = kEnumeration,
          .access = kReadWrite,
          .initial = initial,
          .entries = std::move(entries)};
}

Feature truth(FeatureId id, std::string_view name, std::string_view category, double initial) {
  return {.id = id,
          .name = name,
          .category = category,
          .kind = kBoolean,
          .access = kReadWrite,
          .initial = initial,
          .max = 1.0};
}

Feature command(FeatureId id, std::string_view name, std::string_view category) {
  return {.id = id, .name = name, .category = category, .kind = kCommand, .access = kWriteOnly};
}

std::uint32_t number_of(wire::PixelFormat format) {
  return static_cast<std::uint32_t>(format);
}

Feature locked(Feature feature) {
  feature.locked_in_acquisition = true;
  return feature;
}

void add_image_format(std::vector<Feature>& list, const Description& camera) {
  using enum FeatureId;
  const double width = camera.sensor_width;
  const double height = camera.sensor_height;
  list.push_back(read_only(kSensorWidth, "SensorWidth", width));
  list.push_back(read_only(kSensorHeight, "SensorHeight", height));
  list.push_back(read_only(kWidthMax, "WidthMax", width));
  list.push_back(read_only(kHeightMax, "HeightMax", height));
  list.push_back(read_only(kOffsetXMax, "OffsetXMax", 0.0));
  list.push_back(read_only(kOffsetYMax, "OffsetYMax", 0.0));
  list.push_back(locked(integer(kWidth, "Width", width, kMinSide, width, "WidthMax")));
  list.push_back(locked(integer(kHeight, "Height", height, kMinSide, height, "HeightMax")));
  list.push_back(integer(kOffsetX, "OffsetX", 0.0, 0.0, width, "OffsetXMax"));
  list.push_back(integer(kOffsetY, "OffsetY", 0.0, 0.0, height, "OffsetYMax"));
  Entries formats;
  for (const auto format : {wire::PixelFormat::kMono8, wire::PixelFormat::kMono12Packed, wire::PixelFormat::kMono16})
    formats.emplace_back(wire::name_of(format), number_of(format));
  list.push_back(
      locked(choice(kPixelFormat, "PixelFormat", "ImageFormatControl", formats, number_of(wire::PixelFormat::kMono8))));
  list.push_back(read_only(kPayloadSize, "PayloadSize", width * height));
}

// The names are those of Point Grey's description, where the standard says ...FrameRateEnable. A camera fresh from its
// box has its automatic functions on.
void add_acquisition(std::vector<Feature>& list) {
  using enum FeatureId;
  const std::string_view category = "AcquisitionControl";
  list.push_back(choice(kAcquisitionMode, "AcquisitionMode", category, {{"Continuous", 0}, {"SingleFrame", 1}}, 0.0));
  list.push_back(command(kAcquisitionStart, "AcquisitionStart", category));
  list.push_back(command(kAcquisitionStop, "AcquisitionStop", category));
  list.push_back(choice(kFrameRateAuto, "AcquisitionFrameRateAuto", category, kAuto, kContinuous));
  list.push_back(truth(kFrameRateEnabled, "AcquisitionFrameRateEnabled", category, 1.0));
  list.push_back(real(kFrameRate, "AcquisitionFrameRate", category, "Hz", 20.0, 0.1, 1000.0));
  list.push_back(choice(kTriggerSelector, "TriggerSelector", category, {{"FrameStart", 0}}, 0.0));
  list.push_back(choice(kTriggerMode, "TriggerMode", category, kOffOn, 0.0));
  list.push_back(choice(kTriggerSource, "TriggerSource", category, {{"Line0", 0}, {"Software", 7}}, 0.0));
  list.push_back(command(kTriggerSoftware, "TriggerSoftware", category));
  list.push_back(choice(kExposureMode, "ExposureMode", category, {{"Timed", 1}}, 1.0));
  list.push_back(choice(kExposureAuto, "ExposureAuto", category, kAuto, kContinuous));
  list.push_back(real(kExposureTime, "ExposureTime", category, "us", 10000.0, 5.0, 3.2e7));
}

void add_analog(std::vector<Feature>& list) {
  using enum FeatureId;
  const std::string_view category = "AnalogControl";
  list.push_back(choice(kGainAuto, "GainAuto", category, kAuto, kContinuous));
  list.push_back(real(kGain, "Gain", category, "dB", 0.0, 0.0, 48.0));
  list.push_back(real(kBlackLevel, "BlackLevel", category, "%", 1.5625, 0.0, 12.5));
  // Gamma and sharpness are registers only: pixels come without either.
  list.push_back(truth(kGammaEnabled, "GammaEnabled", category, 1.0));
  list.push_back(real(kGamma, "Gamma", category, "", 1.25, 0.5, 4.0));
  list.push_back(truth(kSharpnessEnabled, "SharpnessEnabled", category, 1.0));
}

}  // namespace

std::vector<Feature> features_of(const Description& description) {
  std::vector<Feature> list;
  add_image_format(list, description);
  add_acquisition(list);
  add_analog(list);
  return list;
}

}  // namespace vbar::gige
