#include "hil_drivers/gige/camera/camera.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include <fmt/format.h>

#include "hil_drivers/gige/camera/aravis_features.h"
#include "hil_drivers/gige/protocol/gvsp.h"
#include "hil_drivers/gige/protocol/stream_setup.h"

namespace vbar::gige {
namespace {

using Clock = std::chrono::steady_clock;
using twins::camera::Region;

constexpr int kBuffers = 3;
constexpr guint64 kSliceUs = 20'000;
constexpr std::uint32_t kManufacturerInfoAddress = 0xA8, kManufacturerInfoBytes = 48;
constexpr double kExposureTolerance = 0.01;
// Bootstrap registers of GigE Vision.
constexpr guint64 kTimestampControl = 0x0944, kTimestampHigh = 0x0948, kTimestampLow = 0x094C;
constexpr guint32 kLatchTimestamp = 2;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

const char* name_of(ArvBufferStatus status) {
  switch (status) {
    case ARV_BUFFER_STATUS_SUCCESS:
      return "success";
    case ARV_BUFFER_STATUS_CLEARED:
      return "cleared";
    case ARV_BUFFER_STATUS_TIMEOUT:
      return "its last packets did not come";
    case ARV_BUFFER_STATUS_MISSING_PACKETS:
      return "packets are missing";
    case ARV_BUFFER_STATUS_WRONG_PACKET_ID:
      return "a wrong packet number";
    case ARV_BUFFER_STATUS_SIZE_MISMATCH:
      return "another size than announced";
    case ARV_BUFFER_STATUS_FILLING:
      return "not complete";
    case ARV_BUFFER_STATUS_ABORTED:
      return "aborted";
    case ARV_BUFFER_STATUS_UNKNOWN:
      break;
  }
  return "unknown";
}

}  // namespace

struct Camera::Stop {
  std::atomic<bool> requested{false};
};

/// The device and its stream while the camera is open.
class Camera::Connection {
 public:
  explicit Connection(const Settings& settings) : settings_(settings), padding_(settings.converter_bits) { connect(); }

  ~Connection() {
    if (!device_) return;
    if (camera_answers(settings_.address, 2, std::chrono::milliseconds(250))) {
      release(device_, stream_, is_started_);
      return;
    }
    // Aravis asks a silent camera for ten seconds to release it; the driver does not wait for that.
    std::thread([device = std::move(device_), stream = std::move(stream_), started = is_started_]() mutable {
      release(device, stream, started);
    }).detach();
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  Identity identify() {
    Identity identity;
    identity.vendor = features().text("DeviceVendorName");
    identity.model = features().text("DeviceModelName");
    identity.version = features().text("DeviceVersion");
    const auto serial_name =
        arv_device_get_feature(device_.get(), "DeviceSerialNumber") != nullptr ? "DeviceSerialNumber" : "DeviceID";
    identity.serial = features().text(serial_name);
    std::array<char, kManufacturerInfoBytes + 1> text{};
    GlibError error;
    arv_device_read_memory(device_.get(), kManufacturerInfoAddress, kManufacturerInfoBytes, text.data(), error.out());
    if (error) throw FeatureError(fmt::format("the manufacturer's information cannot be read: {}", error.text()));
    identity.manufacturer_info = text.data();
    check(identity);
    return identity;
  }

  void configure() {
    // A camera that an earlier owner left running rejects settings.
    features().execute("AcquisitionStop");
    set_trigger();
    set_image_functions();
    set_region();
    set_exposure(settings_.exposure_s);
    set_transport();
  }

  void start() {
    GlibError error;
    stream_.reset(arv_device_create_stream(device_.get(), nullptr, nullptr, error.out()));
    if (!stream_) throw FeatureError(fmt::format("the stream channel is not opened: {}", error.text()));
    // On one cable nothing overtakes: a gap is asked for at once. What was asked for gets the time of a device that is
    // not run for a while before it is asked for again: earlier repetitions fill the buffer of a busy computer.
    g_object_set(stream_.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
                 static_cast<gint>(buffer_.requested_bytes), "packet-resend", ARV_GV_STREAM_PACKET_RESEND_ALWAYS,
                 "packet-request-ratio", 1.0, "initial-packet-timeout", guint{0}, "packet-timeout", guint{20'000},
                 "frame-retention", guint{500'000}, nullptr);
    payload_ = static_cast<std::size_t>(features().integer("PayloadSize"));
    for (int k = 0; k < kBuffers; ++k) arv_stream_push_buffer(stream_.get(), arv_buffer_new(payload_, nullptr));
    has_clock_ = camera_time_ns().has_value();
    features().execute("AcquisitionStart");
    is_started_ = true;
  }

  void set_exposure(double exposure_s) {
    const double exposure_us = 1e6 * exposure_s;
    features().set_number({"ExposureTime", "ExposureTimeAbs"}, exposure_us, kExposureTolerance * exposure_us,
                          Need::kRequired);
    settings_.exposure_s = exposure_s;
  }

  std::variant<Frame, NoFrame> take(const std::atomic<bool>& stop) {
    auto result = take_triggered(stop);
    is_image_pending_ = !std::holds_alternative<Frame>(result);
    return result;
  }

  [[nodiscard]] std::int64_t stale_images() const { return stale_images_; }

  [[nodiscard]] std::string transport() const {
    return description(buffer_, delay_ns_, static_cast<std::size_t>(settings_.packet_size));
  }

 private:
  std::variant<Frame, NoFrame> take_triggered(const std::atomic<bool>& stop) {
    std::uint64_t earliest_ns = last_timestamp_ns_ + 1;
    if (has_clock_) {
      const std::optional<std::uint64_t> now_ns = camera_time_ns();
      if (!now_ns) return control_failure("its clock cannot be latched");
      earliest_ns = std::max(earliest_ns, *now_ns);
    } else if (is_image_pending_) {
      try {
        restart();
      } catch (const FeatureError& error) {
        return control_failure(error.what());
      }
    }
    discard_waiting_images();
    const std::int64_t stale_before = stale_images_;
    guint64 resent_before = 0, missing = 0;
    arv_gv_stream_get_statistics(ARV_GV_STREAM(stream_.get()), &resent_before, &missing);
    const Clock::time_point begin = Clock::now();
    if (auto failure = trigger()) return *failure;
    const double limit_s = settings_.exposure_s + transfer_s() + settings_.timeout_s;
    for (;;) {
      if (stop) return failure(NoFrame::Reason::kStopped, "stopped");
      if (ArvBuffer* const buffer = arv_stream_timeout_pop_buffer(stream_.get(), kSliceUs)) {
        auto result = read(buffer);
        const std::uint64_t timestamp_ns = arv_buffer_get_timestamp(buffer);
        arv_stream_push_buffer(stream_.get(), buffer);
        if (auto* frame = std::get_if<Frame>(&result)) {
          if (timestamp_ns != 0 && timestamp_ns < earliest_ns) {
            ++stale_images_;
            continue;
          }
          frame->stale_images = stale_images_ - stale_before;
          frame->timestamp_ns = last_timestamp_ns_ = timestamp_ns;
          guint64 resent = 0;
          arv_gv_stream_get_statistics(ARV_GV_STREAM(stream_.get()), &resent, &missing);
          frame->packets_resent = static_cast<std::int64_t>(resent - resent_before);
          frame->receive_s = seconds_since(begin);
        }
        return result;
      }
      if (seconds_since(begin) <= limit_s) continue;
      if (stale_images_ > stale_before)
        return failure(NoFrame::Reason::kStale,
                       fmt::format("within {:.1f} s of the trigger only an image of an exposure before it", limit_s));
      return failure(NoFrame::Reason::kTimeout, fmt::format("no image within {:.1f} s of the trigger", limit_s));
    }
  }

  static void release(ObjectPtr<ArvDevice>& device, ObjectPtr<ArvStream>& stream, bool is_started) {
    stream.reset();
    if (is_started) {
      GlibError ignored;
      arv_device_execute_command(device.get(), "AcquisitionStop", ignored.out());
    }
    device.reset();
  }

  [[nodiscard]] Features features() const { return Features(device_.get()); }

  [[nodiscard]] NoFrame failure(NoFrame::Reason reason, const std::string& text) const {
    return {reason, fmt::format("camera {}: {}", settings_.address, text)};
  }

  void connect() {
    const std::string own_address =
        settings_.interface_address.empty() ? routing_address(settings_.address) : settings_.interface_address;
    if (!camera_answers(settings_.address, 3, std::chrono::milliseconds(500))) throw FeatureError("it does not answer");
    const ObjectPtr<GInetAddress> own(g_inet_address_new_from_string(own_address.c_str()));
    const ObjectPtr<GInetAddress> peer(g_inet_address_new_from_string(settings_.address.c_str()));
    if (!own) throw FeatureError(fmt::format("interface \"{}\" is not an IPv4 address", own_address));
    GlibError error;
    device_.reset(arv_gv_device_new(own.get(), peer.get(), error.out()));
    if (!device_) throw FeatureError(error.text());
    if (!arv_gv_device_is_controller(ARV_GV_DEVICE(device_.get())))
      throw FeatureError("it is owned by another program");
    arv_device_set_register_cache_policy(device_.get(), ARV_REGISTER_CACHE_POLICY_DISABLE);
    arv_gv_device_set_packet_size_adjustment(ARV_GV_DEVICE(device_.get()), ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
    arv_gv_device_set_stream_options(ARV_GV_DEVICE(device_.get()), ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  }

  void check(const Identity& identity) const {
    if (identity.model.find(settings_.model) == std::string::npos)
      throw FeatureError(
          fmt::format("it is a \"{}\" of \"{}\"; expected \"{}\"", identity.model, identity.vendor, settings_.model));
    if (!settings_.serial.empty() && identity.serial != settings_.serial)
      throw FeatureError(
          fmt::format("its serial number is \"{}\"; expected \"{}\"", identity.serial, settings_.serial));
    const auto width = features().integer_if_available("SensorWidth");
    const auto height = features().integer_if_available("SensorHeight");
    const auto differs = [](std::optional<gint64> found, int wanted) {
      return wanted != 0 && found && *found != wanted;
    };
    if (differs(width, settings_.sensor_width) || differs(height, settings_.sensor_height))
      throw FeatureError(fmt::format("its sensor has {} x {} pixels; expected {} x {}", width.value_or(0),
                                     height.value_or(0), settings_.sensor_width, settings_.sensor_height));
  }

  void set_trigger() const {
    const Features set = features();
    set.set_text({"AcquisitionMode"}, "Continuous", Need::kRequired);
    set.set_text({"TriggerSelector"}, "FrameStart", Need::kIfAvailable);
    set.set_text({"TriggerMode"}, "Off", Need::kRequired);
    set.set_text({"TriggerSource"}, "Software", Need::kRequired);
    set.set_text({"TriggerMode"}, "On", Need::kRequired);
  }

  void set_image_functions() const {
    const Features set = features();
    // A frame rate would limit how often the camera accepts triggers.
    set.set_text({"AcquisitionFrameRateAuto"}, "Off", Need::kIfAvailable);
    set.set_flag({"AcquisitionFrameRateEnabled", "AcquisitionFrameRateEnable"}, false, Need::kIfAvailable);
    set.set_text({"ExposureMode"}, "Timed", Need::kIfAvailable);
    set.set_text({"ExposureAuto"}, "Off", Need::kIfAvailable);
    set.set_text({"GainAuto"}, "Off", Need::kIfAvailable);
    set.set_flag({"GammaEnabled", "GammaEnable"}, false, Need::kIfAvailable);
    set.set_flag({"SharpnessEnabled", "SharpnessEnable"}, false, Need::kIfAvailable);
    set.set_number({"Gain"}, settings_.gain_db, 0.05, Need::kIfAvailable);
    if (settings_.black_level_percent)
      set.set_number({"BlackLevel"}, *settings_.black_level_percent, 0.03, Need::kRequired);
    set.set_text({"PixelFormat"}, wire::name_of(settings_.pixel_format), Need::kRequired);
  }

  void set_region() const {
    const Features set = features();
    const Region& region = settings_.region;
    // At the corner every size is allowed.
    for (const char* offset : {"OffsetX", "OffsetY"}) set.set_integer({offset}, 0, Need::kIfAvailable);
    set.set_integer({"Width"}, region.width, Need::kRequired);
    set.set_integer({"Height"}, region.height, Need::kRequired);
    const auto need = [](int offset) { return offset == 0 ? Need::kIfAvailable : Need::kRequired; };
    set.set_integer({"OffsetX"}, region.x, need(region.x));
    set.set_integer({"OffsetY"}, region.y, need(region.y));
  }

  void set_transport() {
    const Features set = features();
    set.set_integer({"GevSCPSPacketSize"}, settings_.packet_size, Need::kRequired);
    const auto packet_size = static_cast<std::size_t>(settings_.packet_size);
    const std::size_t image = image_bytes();
    buffer_ = granted_socket_buffer(settings_.socket_buffer_bytes.value_or(wanted_socket_buffer(image, packet_size)));
    delay_ns_ =
        settings_.packet_delay_us ? 1e3 * *settings_.packet_delay_us : packet_delay_ns(buffer_, image, packet_size);
    GlibError error;
    const guint64 frequency = arv_gv_device_get_timestamp_tick_frequency(ARV_GV_DEVICE(device_.get()), error.out());
    if (error || frequency == 0) throw FeatureError("its tick frequency cannot be read");
    tick_frequency_hz_ = frequency;
    const double ticks = std::ceil(1e-9 * delay_ns_ * static_cast<double>(frequency));
    set.set_integer({"GevSCPD"}, static_cast<gint64>(ticks), ticks > 0.0 ? Need::kRequired : Need::kIfAvailable);
  }

  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(settings_.region.width) * static_cast<std::size_t>(settings_.region.height);
  }
  [[nodiscard]] std::size_t image_bytes() const { return wire::image_bytes(settings_.pixel_format, pixels()); }

  /// Returns the time of one image over the wire, at least that of a link with 100 MB/s.
  [[nodiscard]] double transfer_s() const {
    const auto data = static_cast<double>(static_cast<std::size_t>(settings_.packet_size) - wire::kPacketOverheadBytes);
    const auto bytes = static_cast<double>(image_bytes());
    return bytes / 100e6 + bytes / data * 1e-9 * delay_ns_;
  }

  /// Returns the camera's present time, in the unit of its time stamps; empty: it has no clock that can be latched.
  std::optional<std::uint64_t> camera_time_ns() {
    GlibError error;
    arv_device_write_register(device_.get(), kTimestampControl, kLatchTimestamp, error.out());
    if (error) return std::nullopt;
    std::uint64_t ticks = 0;
    for (const guint64 address : {kTimestampHigh, kTimestampLow}) {
      guint32 word = 0;
      arv_device_read_register(device_.get(), address, &word, error.out());
      if (error) return std::nullopt;
      ticks = ticks << 32U | word;
    }
    if (ticks == 0) return std::nullopt;
    // As Aravis converts the stamps of images.
    constexpr std::uint64_t kNsPerSecond = 1'000'000'000;
    return ticks / tick_frequency_hz_ * kNsPerSecond + ticks % tick_frequency_hz_ * kNsPerSecond / tick_frequency_hz_;
  }

  /// Ends what is under way: the new stream has another port.
  void restart() {
    GlibError ignored;
    arv_device_execute_command(device_.get(), "AcquisitionStop", ignored.out());
    is_started_ = false;
    stream_.reset();
    start();
  }

  void discard_waiting_images() {
    while (ArvBuffer* const buffer = arv_stream_try_pop_buffer(stream_.get())) {
      if (arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS) ++stale_images_;
      arv_stream_push_buffer(stream_.get(), buffer);
    }
  }

  std::optional<NoFrame> trigger() {
    GlibError error;
    arv_device_execute_command(device_.get(), "TriggerSoftware", error.out());
    if (!error) return std::nullopt;
    return control_failure(fmt::format("it does not take the trigger: {}", error.text()));
  }

  [[nodiscard]] NoFrame control_failure(const std::string& text) const {
    if (!arv_gv_device_is_controller(ARV_GV_DEVICE(device_.get())))
      return failure(NoFrame::Reason::kNotOwner, "control of it is lost");
    return failure(NoFrame::Reason::kNoAnswer, text);
  }

  std::variant<Frame, NoFrame> read(ArvBuffer* buffer) {
    const ArvBufferStatus status = arv_buffer_get_status(buffer);
    if (status != ARV_BUFFER_STATUS_SUCCESS)
      return failure(NoFrame::Reason::kIncomplete, fmt::format("an image is not whole: {}", name_of(status)));
    // The pixels, whatever the label of the buffer: some cameras call images chunk data.
    size_t size = 0;
    const void* const data = arv_buffer_get_data(buffer, &size);
    // With Aravis 0.8.26 the size is 0 for a buffer that it allocated; complete means that `payload_` bytes came.
    size = size == 0 ? payload_ : std::min(size, payload_);
    if (data == nullptr || size < image_bytes())
      return failure(NoFrame::Reason::kInvalid, fmt::format("an image of {} bytes; expected {}", size, image_bytes()));
    if (arv_buffer_get_payload_type(buffer) == ARV_BUFFER_PAYLOAD_TYPE_IMAGE) {
      gint x = 0, y = 0, width = 0, height = 0;
      arv_buffer_get_image_region(buffer, &x, &y, &width, &height);
      const Region& wanted = settings_.region;
      if (width != wanted.width || height != wanted.height || x != wanted.x || y != wanted.y)
        return failure(NoFrame::Reason::kInvalid,
                       fmt::format("an image of region [{}, {}, {}, {}]; expected [{}, {}, {}, {}]", x, y, width,
                                   height, wanted.x, wanted.y, wanted.width, wanted.height));
      const ArvPixelFormat format = arv_buffer_get_image_pixel_format(buffer);
      if (format != static_cast<std::uint32_t>(settings_.pixel_format))
        return failure(NoFrame::Reason::kInvalid, fmt::format("an image of pixel format {:08X}h; expected {}", format,
                                                              wire::name_of(settings_.pixel_format)));
    }
    return unpack({static_cast<const std::uint8_t*>(data), size});
  }

  Frame unpack(wire::ByteSpan bytes) {
    Frame frame;
    frame.width = settings_.region.width;
    frame.height = settings_.region.height;
    frame.dn = wire::unpack_pixels(settings_.pixel_format, pixels(), bytes);
    switch (settings_.pixel_format) {
      case wire::PixelFormat::kMono8:
        frame.bits = 8;
        break;
      case wire::PixelFormat::kMono12Packed:
        frame.bits = 12;
        break;
      case wire::PixelFormat::kMono16:
        padding_.observe(frame.dn);
        frame.bits = padding_.bits();
        for (std::uint16_t& value : frame.dn) value = static_cast<std::uint16_t>(value >> padding_.shift());
        break;
    }
    return frame;
  }

  Settings settings_;
  ObjectPtr<ArvDevice> device_;
  ObjectPtr<ArvStream> stream_;
  SocketBuffer buffer_;
  double delay_ns_ = 0.0;
  std::size_t payload_ = 0;
  PixelPadding padding_;
  std::uint64_t tick_frequency_hz_ = 1;
  std::uint64_t last_timestamp_ns_ = 0;  ///< camera time of the last whole image
  std::int64_t stale_images_ = 0;
  bool has_clock_ = false;         ///< that can be latched
  bool is_image_pending_ = false;  ///< the last trigger has had no image
  bool is_started_ = false;
};

bool Camera::Identity::is_emulated() const {
  return manufacturer_info.find("emulat") != std::string::npos;
}

Camera::Camera(Settings settings) : settings_(std::move(settings)), stop_(std::make_unique<Stop>()) {}

Camera::~Camera() {
  close();
}

void Camera::open() {
  close();
  try {
    auto connection = std::make_unique<Connection>(settings_);
    identity_ = connection->identify();
    connection->configure();
    connection->start();
    connection_ = std::move(connection);
  } catch (const std::exception& error) {
    throw CameraError(fmt::format("camera {}: {}", settings_.address, error.what()));
  }
}

std::variant<Frame, NoFrame> Camera::take() {
  if (!connection_) throw CameraError(fmt::format("camera {}: it is not open", settings_.address));
  if (stop_->requested) return NoFrame{NoFrame::Reason::kStopped, fmt::format("camera {}: stopped", settings_.address)};
  return connection_->take(stop_->requested);
}

void Camera::set_exposure(double exposure_s) {
  if (!connection_) throw CameraError(fmt::format("camera {}: it is not open", settings_.address));
  try {
    connection_->set_exposure(exposure_s);
    settings_.exposure_s = exposure_s;
  } catch (const FeatureError& error) {
    throw CameraError(fmt::format("camera {}: {}", settings_.address, error.what()));
  }
}

void Camera::set_region(const Region& region) {
  settings_.region = region;
  open();
}

void Camera::reconnect() {
  open();
}

void Camera::close() noexcept {
  if (connection_) stale_before_ += connection_->stale_images();
  connection_.reset();
}

std::int64_t Camera::stale_images() const {
  return stale_before_ + (connection_ ? connection_->stale_images() : 0);
}

void Camera::stop() noexcept {
  stop_->requested = true;
}

bool Camera::is_open() const {
  return connection_ != nullptr;
}

const Camera::Identity& Camera::identity() const {
  return identity_;
}

const Camera::Settings& Camera::settings() const {
  return settings_;
}

std::string Camera::transport() const {
  if (!connection_) return "the camera is not open";
  return connection_->transport();
}

}  // namespace vbar::gige
