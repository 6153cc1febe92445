#include "host_sim/mission/body_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "host_sim/mission/read_attitude.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::mission {
namespace {

using fsw::Vector3;

constexpr const char* kBodies = "bodies";  // name of the folder of bodies in the data folder

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

truth::Body read_body(const TableReader& document, std::string name) {
  truth::Body body;
  body.name = std::move(name);
  const auto inertia = read_inertia(document);
  if (!inertia) document.refuse("inertia_kgm2", "nothing", "[xx, yy, zz] or [xx, yy, zz, xy, xz, yz]");
  body.inertia_kgm2 = *inertia;
  body.centre_of_mass_m = read_point(document, "centre_of_mass_m");
  std::vector<Vector3> corners_m;
  for (const TableReader& corner : document.tables("corners")) {
    corners_m.push_back(read_point(corner, "at_m") - body.centre_of_mass_m);
  }
  for (const TableReader& facet : document.tables("facet")) body.facets.push_back(read_facet(facet, corners_m));
  return body;
}

std::vector<Vector3> read_keypoints(const TableReader& document) {
  constexpr double kMinSeparationM = 1e-3;
  std::vector<Vector3> keypoints_m;
  for (const TableReader& keypoint : document.tables("keypoints")) {
    const Vector3 at_m = read_point(keypoint, "at_m");
    for (std::size_t k = 0; k < keypoints_m.size(); ++k)
      if ((at_m - keypoints_m[k]).norm() < kMinSeparationM)
        keypoint.refuse("at_m", "the place of keypoint " + std::to_string(k), "keypoints at least a millimetre apart");
    keypoints_m.push_back(at_m);
  }
  return keypoints_m;
}

/// A row of R_body_file: "+x", "-z".
Vector3 axis_of(const TableReader& section, const std::string& text) {
  const std::size_t axis = text.size() == 2 ? std::string("xyz").find(text[1]) : std::string::npos;
  if (axis == std::string::npos || (text[0] != '+' && text[0] != '-'))
    section.refuse("axes", '"' + text + '"',
                   "\"+x\", \"-x\", \"+y\", \"-y\", \"+z\" or \"-z\" for each axis of the body");
  return (text[0] == '+' ? 1.0 : -1.0) * Vector3::Unit(static_cast<Eigen::Index>(axis));
}

fsw::Matrix3 read_axes(const TableReader& section) {
  const std::vector<std::string> names = section.texts("axes");
  if (names.empty()) return fsw::Matrix3::Identity();
  if (names.size() != 3)
    section.refuse("axes", std::to_string(names.size()) + " of them", "three: of the body's x, y and z");
  fsw::Matrix3 R_body_file;
  for (std::size_t k = 0; k < 3; ++k)
    R_body_file.row(static_cast<Eigen::Index>(k)) = axis_of(section, names[k]).transpose();
  if (std::abs(R_body_file.determinant() - 1.0) > 0.5)
    section.refuse("axes", "axes that are not right-handed", "three axes of the file that form a right-handed frame");
  return R_body_file;
}

std::optional<twins::camera::CadSource> read_cad(const TableReader& document, const std::filesystem::path& folder) {
  if (!document.has("cad")) return std::nullopt;
  const TableReader section = document.table("cad");
  twins::camera::CadSource cad;
  cad.file = folder / section.text("file");
  cad.unit_m = section.number("unit_m", from_to(1e-6, 1e3), 1.0);
  cad.R_body_file = read_axes(section);
  const auto origin = section.three_numbers("origin_m", kLength_m, std::array{0.0, 0.0, 0.0});
  cad.origin_m = {origin[0], origin[1], origin[2]};
  constexpr std::array<std::pair<std::string_view, twins::camera::CadMaterials>, 3> kMaterials{
      {{"file", twins::camera::CadMaterials::kFile},
       {"scaled", twins::camera::CadMaterials::kScaled},
       {"surface", twins::camera::CadMaterials::kSurface}}};
  cad.materials =
      section.choice<twins::camera::CadMaterials>("materials", kMaterials, twins::camera::CadMaterials::kFile);
  if (section.has("surface")) {
    const TableReader surface = section.table("surface");
    const Range share = from_to(0.0, 1.0);
    cad.surface = {surface.number("diffuse", share), surface.number("specular", share, 0.0),
                   surface.number("exponent", from_to(0.0, 1e4), 0.0)};
  }
  if (cad.materials == twins::camera::CadMaterials::kSurface && !cad.surface)
    section.refuse_value("materials", "file or scaled, as cad.surface is missing");
  return cad;
}

/// All that a body file states.
struct BodyFile {
  truth::Body body;
  std::vector<Vector3> keypoints_m;
  std::optional<twins::camera::CadSource> cad;
};

/// `count`: that of the keypoints, if they are required.
BodyFile load(const std::filesystem::path& file, std::optional<std::size_t> count) {
  const toml::table table = parse_toml(read_data_text(file, "a body file (TOML)"), file.string());
  const TableReader document(table, file.string());
  BodyFile loaded{read_body(document, file.stem().string()), read_keypoints(document),
                  read_cad(document, file.parent_path())};
  document.finish();
  if (count && loaded.keypoints_m.size() != *count)
    document.refuse("keypoints", std::to_string(loaded.keypoints_m.size()) + " of them", std::to_string(*count));
  return loaded;
}

}  // namespace

truth::Body load_body(const std::filesystem::path& file) {
  return load(file, std::nullopt).body;
}

std::vector<Vector3> load_keypoints(const std::filesystem::path& file, std::size_t count) {
  return load(file, count).keypoints_m;
}

std::vector<std::string> body_names(const std::filesystem::path& data_directory) {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator it(data_directory / kBodies, error), end; !error && it != end;
       it.increment(error))
    if (it->path().extension() == ".toml") names.push_back(it->path().stem().string());
  std::ranges::sort(names);
  return names;
}

std::filesystem::path body_file_of(const std::filesystem::path& data_directory, const std::string& name) {
  if (std::filesystem::path named(name); named.is_absolute()) return named;
  return data_directory / kBodies / (name + ".toml");
}

twins::camera::CadSource cad_source_of(const std::filesystem::path& data_directory, const std::string& model) {
  const std::filesystem::path file = body_file_of(data_directory, model);
  if (std::filesystem::is_regular_file(file)) {
    if (const auto cad = load(file, std::nullopt).cad) return *cad;
  }
  return {.file = data_directory / "models" / (model + ".obj")};
}

std::map<std::string, twins::camera::CadSource> cad_sources_of(const std::filesystem::path& data_directory,
                                                               std::span<const std::string> models) {
  std::map<std::string, twins::camera::CadSource> sources;
  for (const std::string& model : models) sources.try_emplace(model, cad_source_of(data_directory, model));
  return sources;
}

}  // namespace vbar::mission
