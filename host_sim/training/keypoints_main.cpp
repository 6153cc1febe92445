// vbar_target_keypoints: keypoints of a target for its body file, chosen on its CAD model, and a picture of them.

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "fsw/vision/pose/architecture.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/training/keypoint_choice.h"

namespace {

using vbar::fsw::Vector3;

struct Order {
  std::string target;
  bool shows_own = false;
  std::filesystem::path picture;
};

void print(const std::vector<vbar::training::ChosenKeypoint>& chosen) {
  fmt::print("keypoints = [\n");
  for (const auto& keypoint : chosen)
    fmt::print("  {{ at_m = [{:.4f}, {:.4f}, {:.4f}] }},  # seen from {:.0f} % of all directions\n",
               keypoint.at_body.x(), keypoint.at_body.y(), keypoint.at_body.z(), 100.0 * keypoint.seen_share);
  fmt::print("]\n");
}

void write_picture(const std::filesystem::path& file, const std::string& svg) {
  std::ofstream stream(file);
  stream << svg;
  stream.close();
  if (!stream) throw std::runtime_error(file.string() + ": cannot be written");
}

void answer(const Order& order) {
  const std::filesystem::path data = vbar::mission::data_directory();
  const std::filesystem::path body = vbar::mission::body_file_of(data, order.target);
  const auto model = vbar::twins::camera::load_cad_model(vbar::mission::cad_source_of(data, order.target));
  std::vector<Vector3> keypoints;
  if (order.shows_own) {
    keypoints = vbar::mission::load_keypoints(body, vbar::fsw::pose::kKeypoints);
  } else {
    const auto chosen = vbar::training::choose_keypoints(model, vbar::mission::load_body(body).centre_of_mass_m,
                                                         vbar::fsw::pose::kKeypoints);
    print(chosen);
    for (const auto& keypoint : chosen) keypoints.push_back(keypoint.at_body);
  }
  if (!order.picture.empty()) write_picture(order.picture, vbar::training::keypoint_picture(model, keypoints));
}

}  // namespace

int main(int argc, char** argv) {
  Order order;
  CLI::App app("Chooses the keypoints of a target on its CAD model and prints them as a body file states them");
  app.add_option("target", order.target, "the target: a body file of data/bodies")->required();
  app.add_flag("--own", order.shows_own, "take the keypoints that the body file states; only draw them");
  app.add_option("--picture", order.picture, "SVG file of the model with its keypoints");
  vbar::files::print_parse_errors_by_line(app);
  CLI11_PARSE(app, argc, argv);
  try {
    answer(order);
  } catch (const std::exception& error) {
    vbar::files::print_error("vbar_target_keypoints", error.what());
    return 1;
  }
  return 0;
}
