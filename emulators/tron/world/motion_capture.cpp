#include "emulators/tron/world/motion_capture.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/udp.hpp>
#include <fmt/format.h>

#include "emulators/tron/world/world.h"
#include "hil_drivers/tron/protocols/vicon_stream.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::tron::bench {

BiasField::BiasField(std::uint64_t seed, const std::string& stream, double sigma, const Place& length)
    : amplitude_(sigma * std::sqrt(2.0 / static_cast<double>(kWaves))) {
  engine::RandomStream random(seed, stream);
  for (auto& component : waves_)
    for (PlaneWave& wave : component) {
      for (Eigen::Index k = 0; k < length.size(); ++k) wave.wave_vector[k] = random.normal() / length[k];
      wave.phase = random.uniform(0.0, 2.0 * std::numbers::pi);
    }
}

fsw::Vector3 BiasField::at(const Place& place) const {
  fsw::Vector3 sum = fsw::Vector3::Zero();
  for (std::size_t k = 0; k < waves_.size(); ++k)
    for (const PlaneWave& wave : waves_[k])
      sum[static_cast<Eigen::Index>(k)] += std::cos(wave.wave_vector.dot(place) + wave.phase);
  return amplitude_ * sum;
}

namespace {

using fsw::Matrix3;
using fsw::Vector3;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::array<const char*, kCaptureObjects> kNames{"camera", "target"};
constexpr std::uint64_t kNumbersOfFrame = 6;

std::string stream(const char* error, std::size_t object) {
  return std::string("tron/vicon/") + error + "/" + kNames[object];
}

Matrix3 rotation_by(const Vector3& vector) {
  const double angle = vector.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix() : Matrix3::Identity();
}

/// Any attitude, uniform: Shoemake (1992), "Uniform random rotations".
Matrix3 any_rotation(engine::RandomStream& random) {
  const double share = random.uniform();
  const double a = random.uniform(0.0, 2.0 * std::numbers::pi), b = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double one = std::sqrt(1.0 - share), two = std::sqrt(share);
  return Eigen::Quaterniond(two * std::cos(b), one * std::sin(a), one * std::cos(a), two * std::sin(b))
      .toRotationMatrix();
}

Eigen::Isometry3d object_on_body(const CaptureErrorSizes& sizes, std::uint64_t seed, std::size_t object) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (sizes.object_translation_mm == 0.0) return pose;
  engine::RandomStream random(seed, stream("axes", object));
  pose.linear() = any_rotation(random);
  for (double& component : pose.translation().reshaped())
    component = 1e-3 * sizes.object_translation_mm * random.normal();
  return pose;
}

/// Place, and two of the body's axes, which say its attitude.
BiasField::Place place_of(const Eigen::Isometry3d& pose) {
  BiasField::Place place;
  place << pose.translation(), pose.linear().col(0), pose.linear().col(1);
  return place;
}

BiasField::Place lengths(double place_m, double attitude_rad) {
  BiasField::Place length;
  length << Vector3::Constant(place_m), Vector3::Constant(attitude_rad), Vector3::Constant(attitude_rad);
  return length;
}

BiasField view_bias(const CaptureErrorSizes& sizes, std::uint64_t seed, std::size_t object) {
  return {seed, stream("view", object), sizes.view_rotation_deg * kDegree,
          lengths(sizes.view_length_m, sizes.view_length_deg * kDegree)};
}

}  // namespace

CaptureErrorSizes CaptureErrorSizes::none() {
  CaptureErrorSizes sizes;
  for (const CaptureErrorKey& key : kCaptureErrorKeys)
    if (key.smallest == 0.0) sizes.*key.size = 0.0;
  return sizes;
}

CaptureErrors::CaptureErrors(const CaptureErrorSizes& sizes, std::uint64_t seed)
    : sizes_(sizes),
      seed_(seed),
      T_V_L_(drawn_pose(seed, "tron/vicon/frame", sizes.frame_rotation_deg, sizes.frame_translation_mm)),
      T_body_object_{object_on_body(sizes, seed, 0), object_on_body(sizes, seed, 1)},
      place_bias_m_(seed, "tron/vicon/bias", 1e-3 * sizes.bias_mm,
                    lengths(sizes.bias_length_m, std::numeric_limits<double>::infinity())),
      view_bias_rad_{view_bias(sizes, seed, 0), view_bias(sizes, seed, 1)} {}

Eigen::Isometry3d CaptureErrors::stated(CaptureObject object, const Eigen::Isometry3d& T_L_body,
                                        std::uint64_t frame) const {
  const auto number = static_cast<std::size_t>(object);
  engine::RandomStream noise(seed_, stream("noise", number));
  noise.seek(kNumbersOfFrame * frame);
  Vector3 shift_m, turn_rad;
  for (double& component : shift_m) component = 1e-3 * sizes_.noise_mm * noise.normal();
  for (double& component : turn_rad) component = sizes_.noise_deg * kDegree * noise.normal();
  Eigen::Isometry3d pose = T_L_body * T_body_object_[number];
  const BiasField::Place place = place_of(pose);
  pose.translation() += place_bias_m_.at(place) + shift_m;
  pose.linear() = pose.linear() * rotation_by(view_bias_rad_[number].at(place)) * rotation_by(turn_rad);
  return T_V_L_ * pose;
}

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
