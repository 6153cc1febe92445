// vbar_pose_errors: the pose network's front end on crops of known poses (shards of vbar_training_crops): how large its
// errors are, and whether its covariances are true.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "host_sim/mission/data_file.h"
#include "host_sim/training/circumstances.h"
#include "tests/integration/pose/front_end_errors.h"

namespace {

using namespace vbar;

struct Order {
  std::vector<std::filesystem::path> shards;
  std::string target = "tango";
  std::string weights;
  std::size_t most = 1'000'000;
  std::string list;
  bool shows_acceptance = false;
  fsw::pose::PnpSettings pnp;
};

std::vector<char> file_bytes(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file + ": cannot be read");
  return std::vector<char>(std::istreambuf_iterator<char>(in), {});
}

/// A line a crop.
void write_list(const std::vector<test::PoseError>& poses, const std::string& file) {
  std::ofstream out(file);
  out << "is_there,usable,inliers,mean_square,attitude_sigma_deg,attitude_deg,position_m,normalised\n";
  for (const test::PoseError& p : poses) {
    out << fmt::format("{:d},{},{},{},{},{},{},{}\n", p.is_there, p.usable, p.inliers, p.mean_square,
                       p.attitude_sigma_deg, p.attitude_deg, p.position_m, p.normalised);
  }
}

void judge(const Order& order) {
  const std::filesystem::path data = mission::data_directory();
  const std::string file = (data / "networks" / (order.target + "_keypoints.bin")).string();
  const std::vector<char> weights = file_bytes(order.weights.empty() ? file : order.weights);
  const auto shape = training::TargetShape::load(data, order.target).keypoints;
  test::FrontEndErrors errors(std::as_bytes(std::span(weights)), shape, order.pnp);
  for (const auto& shard : order.shards) {
    for (const test::LabelledView& view : test::read_shard(shard)) {
      if (errors.poses().size() < order.most) errors.add(view);
    }
  }
  fmt::print("{}", errors.report());
  if (!order.list.empty()) write_list(errors.poses(), order.list);
  if (order.shows_acceptance) fmt::print("\n{}", errors.acceptance_table());
}

}  // namespace

int main(int argc, char** argv) {
  Order order;
  CLI::App app("Errors of the pose network's front end on labelled crops");
  app.add_option("shards", order.shards, "files of vbar_training_crops")->required()->check(CLI::ExistingFile);
  app.add_option("--target", order.target, "a body file of data/bodies")->capture_default_str();
  app.add_option("--weights", order.weights, "file of weights; else that of the target in data/networks");
  app.add_option("--most", order.most, "crops");
  app.add_option("--least-inliers", order.pnp.min_inliers, "of a pose")->capture_default_str();
  app.add_option("--most-mean-square", order.pnp.max_mean_square, "of a pose's whitened residuals")
      ->capture_default_str();
  app.add_option("--inlier-sigmas", order.pnp.inlier_sigmas, "of an inlier")->capture_default_str();
  app.add_option("--inlier-floor-px", order.pnp.inlier_floor_px, "of an inlier")->capture_default_str();
  app.add_option("--list", order.list, "file for a line a crop (CSV)");
  app.add_flag("--acceptance", order.shows_acceptance, "a table of other limits");
  CLI11_PARSE(app, argc, argv);
  try {
    judge(order);
  } catch (const std::exception& error) {
    fmt::print(stderr, "vbar_pose_errors: {}\n", error.what());
    return 1;
  }
  return 0;
}
