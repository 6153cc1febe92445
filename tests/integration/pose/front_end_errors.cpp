#include "tests/integration/pose/front_end_errors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include "fsw/vision/pose/heatmap.h"
#include "tests/support/figures.h"
#include "tests/support/tango_view.h"

namespace vbar::test {

namespace {

using fsw::Vector2;
using fsw::Vector6;
using fsw::pose::CropRegion;
using fsw::pose::Keypoint;
using fsw::pose::Keypoints;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

template <class Error, class Member>
std::vector<double> column(const std::vector<Error>& errors, Member member) {
  std::vector<double> values;
  for (const Error& error : errors) values.push_back(error.*member);
  return values;
}

double mean(const std::vector<double>& values) {
  return values.empty() ? 0.0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

template <class Values, class Test>
double share_of(const Values& values, Test test) {
  const auto count = static_cast<double>(std::count_if(values.begin(), values.end(), test));
  return values.empty() ? 0.0 : count / static_cast<double>(values.size());
}

std::vector<PoseError> accepted(const std::vector<PoseError>& poses) {
  std::vector<PoseError> there;
  std::copy_if(poses.begin(), poses.end(), std::back_inserter(there), [](const PoseError& p) { return p.is_there; });
  return there;
}

}  // namespace

FrontEndErrors::FrontEndErrors(std::span<const std::byte> weights, const fsw::pose::KeypointShape& shape,
                               const fsw::pose::PnpSettings& settings)
    : network_(std::make_unique<fsw::pose::KeypointNetwork>()), shape_(shape), settings_(settings) {
  if (network_->load(weights) != fsw::Status::kOk) throw std::runtime_error("not weights of the keypoint network");
}

void FrontEndErrors::add(const LabelledView& view) {
  if (network_->run(view.samples) != fsw::Status::kOk) throw std::runtime_error("the keypoint network refuses a crop");
  const auto sigma = static_cast<double>(network_->calibration().target_sigma_cells);
  Keypoints keypoints;
  for (std::size_t k = 0; k < keypoints.size(); ++k) {
    const auto peak = fsw::pose::read_map(network_->logits(static_cast<int>(k)), sigma);
    keypoints[k] = fsw::pose::keypoint_of(peak, network_->calibration(), view.region);
    add_keypoint(keypoints[k], view, k);
  }
  add_pose(keypoints, view);
}

void FrontEndErrors::add_keypoint(const Keypoint& keypoint, const LabelledView& view, std::size_t k) {
  if (!view.counts[k]) {
    ++beside_map_;
    usable_beside_map_ += keypoint.is_usable ? 1 : 0;
    return;
  }
  ++on_map_;
  if (!keypoint.is_usable) return;
  const Vector2 miss = keypoint.pixel - view.region.pixel_of(view.cells[k], fsw::pose::kMapSide);
  const Eigen::Matrix2d covariance = keypoint.covariance_px2;
  const double sample_px = view.region.side_px / fsw::pose::kCropSide;
  keypoints_.push_back({miss.norm() / sample_px, miss.norm(), miss.dot(Vector2(covariance.llt().solve(miss)))});
}

void FrontEndErrors::add_pose(const Keypoints& keypoints, const LabelledView& view) {
  PoseError error;
  error.usable = static_cast<int>(
      std::count_if(keypoints.begin(), keypoints.end(), [](const Keypoint& k) { return k.is_usable; }));
  const auto seed = static_cast<std::uint32_t>(poses_.size());
  const auto found = fsw::pose::solve_pnp(keypoints, shape_, view.camera, settings_, seed);
  if (found.ok()) {
    const fsw::pose::PnpSolution& s = found.value();
    Vector6 miss;
    miss << turn_between(s.pose.R_camera_body, view.truth.R_camera_body),
        view.truth.position_camera_m - s.pose.position_camera_m;
    const Eigen::Matrix<double, 6, 6> covariance = s.covariance;
    error.is_there = true;
    error.inliers = s.inliers;
    error.mean_square = s.mean_square;
    error.attitude_sigma_deg = std::sqrt(s.covariance.topLeftCorner<3, 3>().trace()) / kDegree;
    error.attitude_deg = miss.head<3>().norm() / kDegree;
    error.position_m = miss.tail<3>().norm();
    error.normalised = miss.dot(Vector6(covariance.llt().solve(miss)));
  }
  poses_.push_back(error);
}

double FrontEndErrors::usable_share() const {
  return on_map_ == 0 ? 0.0 : static_cast<double>(keypoints_.size()) / static_cast<double>(on_map_);
}

double FrontEndErrors::false_share() const {
  return beside_map_ == 0 ? 0.0 : static_cast<double>(usable_beside_map_) / static_cast<double>(beside_map_);
}

double FrontEndErrors::median_keypoint_samples() const {
  return accuracy::quantile(column(keypoints_, &KeypointError::samples), 0.5);
}

double FrontEndErrors::accepted_share() const {
  return share_of(poses_, [](const PoseError& p) { return p.is_there; });
}

double FrontEndErrors::share_beyond(double attitude_deg) const {
  return share_of(accepted(poses_), [&](const PoseError& p) { return p.attitude_deg > attitude_deg; });
}

std::string FrontEndErrors::report() const {
  const auto normalised = column(keypoints_, &KeypointError::normalised);
  const auto poses = accepted(poses_);
  const auto turns = column(poses, &PoseError::attitude_deg);
  const auto shifts = column(poses, &PoseError::position_m);
  const auto squares = column(poses, &PoseError::normalised);
  const auto px = column(keypoints_, &KeypointError::px);
  const auto samples = column(keypoints_, &KeypointError::samples);
  std::string text;
  text += fmt::format("crops {}\n", poses_.size());
  text += fmt::format("keypoints on the map usable {:.1f} %, beside it {:.1f} %\n", 100.0 * usable_share(),
                      100.0 * false_share());
  text += fmt::format("keypoint error, samples: median {:.2f}, 90 % {:.2f}, 99 % {:.2f}; px: median {:.2f}\n",
                      accuracy::quantile(samples, 0.5), accuracy::quantile(samples, 0.9),
                      accuracy::quantile(samples, 0.99), accuracy::quantile(px, 0.5));
  text +=
      fmt::format("  normalised: median {:.2f} (1.39), mean {:.2f} (2), 90 % {:.2f} (4.61), beyond 9.21 {:.1f} % (1)\n",
                  accuracy::quantile(normalised, 0.5), mean(normalised), accuracy::quantile(normalised, 0.9),
                  100.0 * share_of(normalised, [](double x) { return x > 9.21; }));
  text += fmt::format("poses {:.1f} %, beyond 10 deg {:.2f} % of them\n", 100.0 * accepted_share(),
                      100.0 * share_beyond(10.0));
  text += fmt::format("  attitude, deg: median {:.2f}, 90 % {:.2f}; position, m: median {:.3f}, 90 % {:.3f}\n",
                      accuracy::quantile(turns, 0.5), accuracy::quantile(turns, 0.9), accuracy::quantile(shifts, 0.5),
                      accuracy::quantile(shifts, 0.9));
  text += fmt::format("  normalised: median {:.2f} (5.35), mean {:.2f} (6), beyond 16.8 {:.1f} % (1)\n",
                      accuracy::quantile(squares, 0.5), mean(squares),
                      100.0 * share_of(squares, [](double x) { return x > 16.812; }));
  return text;
}

std::string FrontEndErrors::acceptance_table() const {
  std::string text = "inliers  mean square  accepted %  beyond 10 deg %\n";
  for (const int least : {5, 6, 7, 8, 9}) {
    for (const double most : {1e9, 6.0, 4.0, 3.0, 2.0}) {
      const auto is_taken = [&](const PoseError& p) {
        return p.is_there && p.inliers >= least && p.mean_square <= most;
      };
      const double taken = share_of(poses_, is_taken);
      const double wrong = share_of(poses_, [&](const PoseError& p) { return is_taken(p) && p.attitude_deg > 10.0; });
      text += fmt::format("{:7}  {:11.3g}  {:10.1f}  {:15.2f}\n", least, most, 100.0 * taken,
                          taken > 0.0 ? 100.0 * wrong / taken : 0.0);
    }
  }
  return text;
}

namespace {

constexpr std::size_t kHeader = 48;
constexpr std::size_t kNumbers = 56;
constexpr std::size_t kRecord = fsw::pose::kCropSamples + 4 * kNumbers;

std::uint32_t integer_at(const std::string& bytes, std::size_t place) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) value = value << 8 | static_cast<std::uint8_t>(bytes[place + k]);
  return value;
}

LabelledView view_at(const std::string& bytes, std::size_t place) {
  LabelledView view;
  for (std::size_t k = 0; k < view.samples.size(); ++k) {
    view.samples[k] = 0.25F * static_cast<float>(static_cast<std::uint8_t>(bytes[place + k]));
  }
  standardise(view.samples);
  std::array<double, kNumbers> n{};
  for (std::size_t k = 0; k < kNumbers; ++k) {
    const std::uint32_t integer = integer_at(bytes, place + view.samples.size() + 4 * k);
    float value = 0.0F;
    std::memcpy(&value, &integer, sizeof value);
    n[k] = static_cast<double>(value);
  }
  for (std::size_t k = 0; k < view.cells.size(); ++k) {
    view.cells[k] = {n[2 * k], n[2 * k + 1]};
    view.counts[k] = n[22 + k] > 0.5;
  }
  view.truth.R_camera_body = Eigen::Quaterniond(n[36], n[33], n[34], n[35]).normalized().toRotationMatrix();
  view.truth.position_camera_m = {n[37], n[38], n[39]};
  view.region = {{n[40], n[41]}, n[42]};
  view.camera = {.focal_length_px = {n[43], n[43]},
                 .principal_point_px = {n[44], n[45]},
                 .distortion = {n[46], n[47], n[48], n[49], n[50]}};
  return view;
}

}  // namespace

void standardise(fsw::pose::CropSamples& samples) {
  double sum = 0.0;
  double squares = 0.0;
  for (const float sample : samples) {
    sum += static_cast<double>(sample);
    squares += static_cast<double>(sample) * static_cast<double>(sample);
  }
  const double count = static_cast<double>(samples.size());
  const double mean = sum / count;
  const double deviation = std::max(0.5, std::sqrt(std::max(0.0, squares / count - mean * mean)));
  for (float& sample : samples) sample = static_cast<float>((static_cast<double>(sample) - mean) / deviation);
}

std::vector<LabelledView> read_shard(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  const bool is_shard = bytes.size() >= kHeader && bytes.compare(0, 12, "vbar crops 1") == 0 &&
                        integer_at(bytes, 20) == fsw::pose::kCropSide && integer_at(bytes, 28) == kNumbers &&
                        bytes.size() == kHeader + integer_at(bytes, 16) * kRecord;
  if (!is_shard) throw std::runtime_error(file.string() + ": not a whole shard of crops (vbar crops 1)");
  std::vector<LabelledView> views;
  for (std::size_t place = kHeader; place < bytes.size(); place += kRecord) views.push_back(view_at(bytes, place));
  return views;
}

}  // namespace vbar::test
