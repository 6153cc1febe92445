#include "host_sim/mission/body_file.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_sim/mission/read_attitude.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::mission {
namespace {

using fsw::Vector3;

constexpr Range kLength_m = from_to(-1000.0, 1000.0);

Vector3 read_point(const TableReader& section, std::string_view key) {
  const auto v = section.three_numbers(key, kLength_m);
  return {v[0], v[1], v[2]};
}

truth::Facet read_facet(const TableReader& section, const std::vector<Vector3>& corners_m) {
  const double last = static_cast<double>(corners_m.size()) - 1.0;
  std::vector<Vector3> polygon_m;
  if (corners_m.empty()) section.refuse("corners", "a facet of a body without corners", "a body with `corners`");
  for (const double index : section.numbers("corners", 3, 64, from_to(0.0, last))) {
    if (index != std::floor(index)) section.refuse("corners", "a number that is not an integer", "places in `corners`");
    polygon_m.push_back(corners_m[static_cast<std::size_t>(index)]);
  }
  const Range share = from_to(0.0, 1.0);
  const double specular = section.number("specular", share), diffuse = section.number("diffuse", share);
  try {
    return truth::facet_of_polygon(polygon_m, specular, diffuse);
  } catch (const std::invalid_argument& error) {
    section.refuse("", std::string("an invalid facet: ") + error.what(),
                   "a plane convex polygon, anticlockwise from outside, and reflectivities that add to at most 1");
  }
}

}  // namespace

truth::Body load_body(const std::filesystem::path& file) {
  const toml::table table = parse_toml(read_data_text(file, "a body file (TOML)"), file.string());
  const TableReader document(table, file.string());
  truth::Body body;
  body.name = file.stem().string();
  const auto inertia = read_inertia(document);
  if (!inertia) document.refuse("inertia_kgm2", "nothing", "[xx, yy, zz] or [xx, yy, zz, xy, xz, yz]");
  body.inertia_kgm2 = *inertia;
  body.centre_of_mass_m = read_point(document, "centre_of_mass_m");
  std::vector<Vector3> corners_m;
  for (const TableReader& corner : document.tables("corners")) {
    corners_m.push_back(read_point(corner, "at_m") - body.centre_of_mass_m);
  }
  for (const TableReader& facet : document.tables("facet")) body.facets.push_back(read_facet(facet, corners_m));
  document.finish();
  return body;
}

std::vector<Vector3> load_keypoints(const std::filesystem::path& file, std::size_t count) {
  const toml::table table = parse_toml(read_data_text(file, "a file of keypoints (TOML)"), file.string());
  const TableReader document(table, file.string());
  std::vector<Vector3> keypoints_m;
  for (const TableReader& keypoint : document.tables("keypoints")) {
    keypoints_m.push_back(read_point(keypoint, "at_m"));
  }
  document.finish();
  if (keypoints_m.size() != count)
    document.refuse("keypoints", std::to_string(keypoints_m.size()) + " of them", std::to_string(count));
  return keypoints_m;
}

}  // namespace vbar::mission
