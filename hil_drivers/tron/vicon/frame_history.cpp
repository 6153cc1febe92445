#include "hil_drivers/tron/vicon/frame_history.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "hil_drivers/tron/vicon/rotation_order.h"

namespace vbar::tron::vicon {
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

}  // namespace vbar::tron::vicon
