#include "hil_drivers/tron/protocols/vicon_receiver.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <fmt/format.h>
#include <poll.h>

#include "fsw/core/types.h"
#include "hil_drivers/tron/protocols/vicon_stream.h"

namespace vbar::tron::vicon {

namespace {

using fsw::Matrix3;
using fsw::Vector3;

constexpr int kIterations = 20;
constexpr double kConverged = 1e-15;  // rad

Vector3 rotation_vector(const Matrix3& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

Matrix3 rotation_by(const Vector3& vector) {
  const double angle = vector.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix() : Matrix3::Identity();
}

/// Karcher mean on SO(3): Manton (2004), "A globally convergent numerical algorithm for computing the centre of mass on
/// compact Lie groups".
Matrix3 mean_rotation(const std::vector<Eigen::Isometry3d>& poses) {
  Matrix3 mean = poses.front().linear();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Vector3 step = Vector3::Zero();
    for (const auto& pose : poses) step += rotation_vector(mean.transpose() * pose.linear());
    step /= static_cast<double>(poses.size());
    mean = Eigen::Quaterniond(mean * rotation_by(step)).normalized().toRotationMatrix();
    if (step.norm() < kConverged) break;
  }
  return mean;
}

}  // namespace

ObjectAverage average_of(const std::vector<Eigen::Isometry3d>& poses) {
  ObjectAverage average;
  if (poses.empty()) return average;
  const auto count = static_cast<double>(poses.size());
  Vector3 translation = Vector3::Zero();
  for (const auto& pose : poses) translation += pose.translation();
  average.state = ObjectState::kTracked;
  average.frames = static_cast<int>(poses.size());
  average.T_V_object.translation() = translation / count;
  average.T_V_object.linear() = mean_rotation(poses);
  double translation2 = 0.0, rotation2 = 0.0;
  for (const auto& pose : poses) {
    translation2 += (pose.translation() - average.T_V_object.translation()).squaredNorm();
    rotation2 += rotation_vector(average.T_V_object.linear().transpose() * pose.linear()).squaredNorm();
  }
  if (poses.size() > 1) {
    average.translation_scatter_m = std::sqrt(translation2 / (3.0 * (count - 1.0)));
    average.rotation_scatter_rad = std::sqrt(rotation2 / (3.0 * (count - 1.0)));
  }
  return average;
}

namespace {

constexpr std::size_t kHistoryFrames = 1000;
// A frame number this far before the last one is not a late datagram: the source counts from its start again.
constexpr std::int32_t kRestartFrames = 100;

Eigen::Isometry3d pose_of(const TrackedObject& object, const std::string& rotation) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_of(object.rotation_rad, rotation);
  for (std::size_t k = 0; k < 3; ++k)
    pose.translation()[static_cast<Eigen::Index>(k)] = 1e-3 * object.translation_mm[k];
  return pose;
}

}  // namespace

FrameHistory::FrameHistory(std::string camera_object, std::string target_object, std::string rotation)
    : names_{std::move(camera_object), std::move(target_object)}, rotation_(std::move(rotation)) {
  (void)rotation_of({0.0, 0.0, 0.0}, rotation_);  // rejects an unknown order
}

/// Whether the block belongs to frames_.back(), which it begins if it has to.
bool FrameHistory::begins_frame(std::uint32_t number) {
  if (last_number_) {
    const auto step = static_cast<std::int32_t>(number - *last_number_);
    if (step == 0) return !frames_.empty();  // a frame that was cleared between its blocks stays cleared
    if (step < 0 && step > -kRestartFrames) {
      ++counts_.late_blocks;
      return false;
    }
    if (step < 0)
      ++counts_.restarts;
    else
      counts_.frames_lost += static_cast<std::uint64_t>(step) - 1;
  }
  last_number_ = number;
  ++counts_.frames;
  if (frames_.size() == kHistoryFrames) frames_.pop_front();
  frames_.emplace_back();
  return true;
}

void FrameHistory::add(const ObjectBlock& block) {
  if (!begins_frame(block.frame)) return;
  for (std::size_t k = 0; k < names_.size(); ++k)
    if (const TrackedObject* object = block.find(names_[k])) frames_.back()[k] = *object;
}

void FrameHistory::add_unreadable(const std::string& why) {
  ++counts_.unreadable;
  counts_.last_unreadable = why;
}

ObjectState FrameHistory::state_of(Object object, std::size_t first, std::size_t frames, bool has_moved) const {
  const std::size_t enough = (frames + 1) / 2;
  std::size_t tracked = 0, occluded = 0, same = 0;
  for (std::size_t k = first; k < frames_.size(); ++k) {
    const auto& found = frames_[k][object];
    if (!found) continue;
    if (found->is_occluded()) {
      ++occluded;
      continue;
    }
    ++tracked;
    if (averaged_last_[object] && found->has_same_numbers(*averaged_last_[object])) ++same;
  }
  const std::size_t received = frames_.size() - first;
  if (received < enough) return ObjectState::kSilent;
  if (tracked < enough) return 2 * occluded >= received - tracked ? ObjectState::kOccluded : ObjectState::kMissing;
  return has_moved && same == tracked ? ObjectState::kFrozen : ObjectState::kTracked;
}

ObjectAverage FrameHistory::average_of_object(Object object, std::size_t frames, bool has_moved) {
  const std::size_t first = frames_.size() - std::min(frames, frames_.size());
  ObjectAverage average;
  average.state = state_of(object, first, frames, has_moved);
  if (average.state != ObjectState::kTracked) return average;
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t k = first; k < frames_.size(); ++k) {
    const auto& found = frames_[k][object];
    if (!found || found->is_occluded()) continue;
    poses.push_back(pose_of(*found, rotation_));
    averaged_last_[object] = found;
  }
  return average_of(poses);
}

void FrameHistory::count(ObjectState state) {
  switch (state) {
    case ObjectState::kTracked:
      return;
    case ObjectState::kSilent:
      ++counts_.silent;
      return;
    case ObjectState::kMissing:
      ++counts_.missing;
      return;
    case ObjectState::kOccluded:
      ++counts_.occluded;
      return;
    case ObjectState::kFrozen:
      ++counts_.frozen;
      return;
  }
}

CaptureAverage FrameHistory::average(int frames, const Moved& moved) {
  const auto asked = static_cast<std::size_t>(std::max(frames, 1));
  CaptureAverage average;
  average.camera = average_of_object(kCamera, asked, moved.camera);
  average.target = average_of_object(kTarget, asked, moved.target);
  count(average.camera.state);
  count(average.target.state);
  return average;
}

namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

constexpr int kSocketBufferBytes = 4 * 1024 * 1024;  // room for seconds of frames
// A flood of datagrams does not hold the caller for ever.
constexpr int kMaxDatagramsOfDrain = 100000;

}  // namespace

struct Receiver::State {
  State(const ViconSettings& settings, const std::string& rotation, const std::string& address)
      : socket(context),
        history(settings.camera_object, settings.target_object, rotation.empty() ? settings.rotation : rotation),
        datagram(kMaxDatagramBytes + 1) {
    error_code error;
    const auto local = asio::ip::make_address_v4(address, error);
    if (!error) socket.open(udp::v4(), error);
    if (!error) socket.bind(udp::endpoint(local, settings.port), error);
    if (!error) socket.non_blocking(true, error);
    if (error)
      throw std::runtime_error(
          fmt::format("Vicon: UDP port {} of {} is not available: {}", settings.port, address, error.message()));
    error_code ignored;  // the system's default is a working size, too
    socket.set_option(asio::socket_base::receive_buffer_size(kSocketBufferBytes), ignored);
    port = socket.local_endpoint().port();
  }

  void drain() {
    udp::endpoint sender;
    for (int count = 0; count < kMaxDatagramsOfDrain; ++count) {
      error_code error;
      const std::size_t size = socket.receive_from(asio::buffer(datagram), sender, 0, error);
      if (error == asio::error::would_block) return;
      if (error) throw std::runtime_error(fmt::format("Vicon at UDP port {}: {}", port, error.message()));
      try {
        history.add(decode_block(ByteSpan(datagram).first(size)));
      } catch (const std::invalid_argument& refusal) {
        history.add_unreadable(refusal.what());
      }
    }
  }

  asio::io_context context;
  udp::socket socket;
  std::uint16_t port = 0;
  FrameHistory history;
  Bytes datagram;
};

Receiver::Receiver(const ViconSettings& settings, const std::string& rotation, const std::string& address)
    : state_(std::make_unique<State>(settings, rotation, address)) {}

Receiver::~Receiver() = default;

std::uint16_t Receiver::port() const {
  return state_->port;
}

void Receiver::clear() {
  state_->drain();
  state_->history.clear();
}

int Receiver::drain() {
  state_->drain();
  return state_->history.frames();
}

int Receiver::wait_for(int frames, std::chrono::milliseconds timeout) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + timeout;
  for (;;) {
    const int received = drain();
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (received >= frames || left <= 0) return received;
    pollfd waiting{state_->socket.native_handle(), POLLIN, 0};
    ::poll(&waiting, 1, static_cast<int>(std::min<long long>(left, 1000)));
  }
}

CaptureAverage Receiver::average(int frames, const Moved& moved) {
  return state_->history.average(frames, moved);
}

CaptureCounts Receiver::counts() const {
  return state_->history.counts();
}

std::string Receiver::description() const {
  return fmt::format("Vicon at UDP port {}", state_->port);
}

}  // namespace vbar::tron::vicon
