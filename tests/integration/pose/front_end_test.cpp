// The front end with the weights on board on crops that training never saw: another seed, other materials. The crops
// are the first of the held-out set of ci/train.sh.

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host_sim/mission/data_file.h"
#include "host_sim/training/crop_maker.h"
#include "tests/integration/pose/front_end_errors.h"
#include "tests/support/accuracy.h"
#include "tests/support/tango_view.h"

namespace vbar::test {
namespace {

constexpr int kCrops = 600;
constexpr std::uint64_t kHeldOutSeed = 3;

LabelledView view_of(const training::LabelledCrop& crop, const twins::camera::CameraSettings& camera) {
  LabelledView view;
  view.samples = crop.samples;
  standardise(view.samples);
  view.region = crop.circumstances.region;
  std::ranges::fill(view.camera.focal_length_px, camera.focal_length_px());
  view.camera.principal_point_px = {camera.optics.principal_point_px[0], camera.optics.principal_point_px[1]};
  std::ranges::copy(camera.optics.distortion, view.camera.distortion.begin());
  view.truth = {crop.circumstances.R_camera_body, crop.circumstances.centre_of_mass_camera};
  view.cells = crop.cells;
  view.counts = crop.counts;
  return view;
}

const FrontEndErrors& held_out() {
  static const FrontEndErrors errors = [] {
    training::CropMaker maker(mission::data_directory(), "tango", training::CropKind::kHeldOut, kHeldOutSeed);
    FrontEndErrors all(fsw::pose::weights_on_board(), tango_shape(), {});
    training::LabelledCrop crop;
    for (int index = 0; index < kCrops; ++index) {
      maker.make(index, crop);
      all.add(view_of(crop, maker.camera()));
    }
    fmt::print("{}\n{}", all.report(), all.acceptance_table());
    return all;
  }();
  return errors;
}

TEST(FrontEnd, KeypointsOfHeldOutCrops) {
  const FrontEndErrors& errors = held_out();
  accuracy::expect_below("accepted keypoints of the network, median error",
                         fmt::format("truth, {} held-out crops of 128 x 128 samples", kCrops),
                         errors.median_keypoint_samples(), 1.5, "samples");
  EXPECT_GT(errors.usable_share(), 0.7);
}

// The median of chi-square with two degrees of freedom is 1.39. How far its errors' distribution may be from that: a
// sixth in sigma, which the filter's own scale learns.
TEST(FrontEnd, CovariancesAreTrue) {
  std::vector<double> squares;
  for (const KeypointError& error : held_out().keypoints()) squares.push_back(error.normalised);
  const double median = accuracy::quantile(squares, 0.5);
  accuracy::expect_below(
      "keypoint covariances: median of the normalised squared error, deviation from 1.386 (chi-square)",
      fmt::format("truth, {} held-out crops", kCrops), std::abs(median / 1.386 - 1.0), 0.36, "relative");
}

TEST(FrontEnd, PosesOfHeldOutCrops) {
  const FrontEndErrors& errors = held_out();
  EXPECT_GT(errors.accepted_share(), 0.85);
  int sure = 0, wrong = 0;
  for (const PoseError& pose : errors.poses()) {
    const bool is_sure = pose.is_there && pose.inliers >= 8;
    sure += is_sure ? 1 : 0;
    wrong += is_sure && pose.attitude_deg > 10.0 ? 1 : 0;
  }
  EXPECT_GT(sure, 0.7 * kCrops);
  accuracy::expect_below("single-image poses of 8 or more inliers with an error of 10 deg or more",
                         fmt::format("truth, {} held-out crops", kCrops), static_cast<double>(wrong) / sure, 0.02,
                         "of them");
}

}  // namespace
}  // namespace vbar::test
