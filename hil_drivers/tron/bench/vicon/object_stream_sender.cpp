#include "hil_drivers/tron/bench/vicon/object_stream_sender.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/udp.hpp>
#include <fmt/format.h>

#include "hil_drivers/tron/vicon/rotation_order.h"
#include "hil_drivers/tron/vicon/wire/object_stream.h"

namespace vbar::tron::bench {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

// Bench time is a multiple of the robot cycle, and so is rarely exactly that of a frame.
constexpr double kRounding = 1e-9;

}  // namespace

struct ObjectStreamSender::State {
  struct Object {
    CaptureObject object;
    std::string name;
    bool is_hidden = false, is_zero = false, is_frozen = false;
    double offset_m = 0.0;
    std::optional<vicon::TrackedObject> sent_last = std::nullopt;
  };

  State(asio::io_context& context, const ObjectStreamSettings& asked, const CaptureErrors& drawn, TruePose poses)
      : settings(asked),
        errors(drawn),
        true_pose(std::move(poses)),
        socket(context),
        objects{Object{CaptureObject::kCamera, asked.vicon.camera_object},
                Object{CaptureObject::kTarget, asked.vicon.target_object}} {
    error_code error;
    const auto address = asio::ip::make_address_v4(settings.address, error);
    if (!error) socket.open(udp::v4(), error);
    if (!error) socket.non_blocking(true, error);
    if (error) throw std::runtime_error(fmt::format("motion capture to {}: {}", settings.address, error.message()));
    computer = {address, settings.vicon.port};
    (void)vicon::encode_frame({0, {{settings.vicon.camera_object}, {settings.vicon.target_object}}},
                              settings.block_bytes);  // rejects names and sizes
  }

  std::optional<vicon::TrackedObject> stated(Object& object) const {
    if (object.is_hidden) return std::nullopt;
    if (object.is_frozen && object.sent_last) return object.sent_last;
    vicon::TrackedObject tracked{object.name};
    const auto pose = object.is_zero ? std::nullopt : true_pose(object.object);
    if (pose) {
      const Eigen::Isometry3d T_V_object = errors.stated(object.object, *pose, sent);
      for (std::size_t k = 0; k < 3; ++k)
        tracked.translation_mm[k] = 1e3 * T_V_object.translation()[static_cast<Eigen::Index>(k)];
      tracked.translation_mm[0] += 1e3 * object.offset_m;
      tracked.rotation_rad = vicon::angles_of(T_V_object.linear(), settings.vicon.rotation);
    }
    object.sent_last = tracked;
    return tracked;
  }

  void send_frame() {
    vicon::ObjectBlock frame;
    frame.frame = settings.first_frame + static_cast<std::uint32_t>(sent);
    for (Object& object : objects)
      if (auto tracked = stated(object)) frame.objects.push_back(*std::move(tracked));
    for (const vicon::Bytes& block : vicon::encode_frame(frame, settings.block_bytes)) {
      error_code ignored;  // no listener: as a real one
      socket.send_to(asio::buffer(block), computer, 0, ignored);
    }
    ++sent;
  }

  ObjectStreamSettings settings;
  const CaptureErrors& errors;
  TruePose true_pose;
  udp::socket socket;
  udp::endpoint computer;
  std::array<Object, kCaptureObjects> objects;
  std::uint64_t sent = 0;
};

ObjectStreamSender::ObjectStreamSender(asio::io_context& context, const ObjectStreamSettings& settings,
                                       const CaptureErrors& errors, TruePose true_pose)
    : state_(std::make_unique<State>(context, settings, errors, std::move(true_pose))) {}

ObjectStreamSender::~ObjectStreamSender() = default;

int ObjectStreamSender::tick(double bench_s) {
  const double due = std::floor(bench_s * state_->settings.vicon.rate_hz + kRounding);
  int frames = 0;
  for (; static_cast<double>(state_->sent) < due; ++frames) state_->send_frame();
  return frames;
}

void ObjectStreamSender::set_hidden(CaptureObject object, bool is_hidden) {
  state_->objects[static_cast<std::size_t>(object)].is_hidden = is_hidden;
}

void ObjectStreamSender::set_zeros(CaptureObject object, bool is_zero) {
  state_->objects[static_cast<std::size_t>(object)].is_zero = is_zero;
}

void ObjectStreamSender::set_frozen(CaptureObject object, bool is_frozen) {
  state_->objects[static_cast<std::size_t>(object)].is_frozen = is_frozen;
}

void ObjectStreamSender::set_offset(CaptureObject object, double offset_m) {
  state_->objects[static_cast<std::size_t>(object)].offset_m = offset_m;
}

std::uint64_t ObjectStreamSender::frames() const {
  return state_->sent;
}

}  // namespace vbar::tron::bench
