#include "hil_drivers/tron/calibration/calibration_data.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/files/output_file.h"
#include "host_sim/files/text_lines.h"

namespace vbar::tron::calibrate {

namespace {

using Eigen::Vector3d;

Eigen::Index axis_of(char name) {
  return name - 'x';
}

}  // namespace

Eigen::Isometry3d reordered(const Eigen::Isometry3d& pose, const std::string& from, const std::string& to) {
  if (from == to) return pose;
  const Vector3d in_order = pose.linear().eulerAngles(axis_of(from[0]), axis_of(from[1]), axis_of(from[2]));
  Vector3d angles;  // about x, y, z
  for (std::size_t k = 0; k < 3; ++k) angles[axis_of(from[k])] = in_order[static_cast<Eigen::Index>(k)];
  Eigen::Isometry3d result = pose;
  result.linear().setIdentity();
  for (const char name : to) {
    const Eigen::Index axis = axis_of(name);
    result.linear() = result.linear() * Eigen::AngleAxisd(angles[axis], Vector3d::Unit(axis)).toRotationMatrix();
  }
  return result;
}

namespace {

using nlohmann::json;

constexpr const char* kFormat = "vbar tron calibration data 1";

template <typename Vector>
json array_of(const Vector& vector) {
  json array = json::array();
  for (const double number : vector) array.push_back(number);
  return array;
}

/// Quaternion w, x, y, z, then the place.
json pose_of(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return array_of(
      std::array{q.w(), q.x(), q.y(), q.z(), pose.translation().x(), pose.translation().y(), pose.translation().z()});
}

json json_of(const Measurement& measurement) {
  json object;
  object["camera_rad"] = array_of(measurement.posture.camera_rad);
  object["target_rad"] = array_of(measurement.posture.target_rad);
  object["carriage_m"] = measurement.posture.carriage_m;
  json corners = json::array();
  for (const Corner& corner : measurement.corners)
    corners.push_back(json::array({corner.id, corner.px.x(), corner.px.y()}));
  object["corners"] = corners;
  if (measurement.vicon) {
    object["vicon_camera"] = pose_of(measurement.vicon->T_V_camera);
    object["vicon_target"] = pose_of(measurement.vicon->T_V_target);
  }
  return object;
}

/// Reads an object, naming where it is in the file.
class Reader {
 public:
  Reader(const json& value, std::string file, std::string place)
      : value_(value), file_(std::move(file)), place_(std::move(place)) {
    if (!value_.is_object()) refuse("", "an object");
  }

  [[noreturn]] void refuse(const std::string& key, const std::string& expected) const {
    throw std::runtime_error(
        fmt::format("{}: {}{}{}: expected {}", file_, place_, place_.empty() || key.empty() ? "" : ".", key, expected));
  }
  [[nodiscard]] bool has(const char* key) const { return value_.contains(key); }
  [[nodiscard]] const json& at(const char* key, const std::string& expected) const {
    const auto found = value_.find(key);
    if (found == value_.end()) refuse(key, expected);
    return *found;
  }
  [[nodiscard]] double number(const char* key, double low, double high) const {
    const std::string expected = fmt::format("a number from {} to {}", low, high);
    const json& value = at(key, expected);
    if (!value.is_number()) refuse(key, expected);
    const double number = value.get<double>();
    if (!(number >= low && number <= high)) refuse(key, expected);
    return number;
  }
  [[nodiscard]] std::string text(const char* key) const {
    const json& value = at(key, "a text");
    if (!value.is_string()) refuse(key, "a text");
    return value.get<std::string>();
  }
  [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count, double most) const {
    return numbers(at(key, "an array"), key, count, most);
  }
  [[nodiscard]] std::vector<double> numbers(const json& value, const std::string& key, std::size_t count,
                                            double most) const {
    const std::string expected = fmt::format("{} numbers from {} to {}", count, -most, most);
    if (!value.is_array() || value.size() != count) refuse(key, expected);
    std::vector<double> result;
    for (const json& element : value) {
      if (!element.is_number()) refuse(key, expected);
      const double number = element.get<double>();
      if (!(std::abs(number) <= most)) refuse(key, expected);
      result.push_back(number);
    }
    return result;
  }
  [[nodiscard]] Eigen::Isometry3d pose(const char* key) const {
    const std::vector<double> n = numbers(key, 7, 1e3);
    const Eigen::Quaterniond q(n[0], n[1], n[2], n[3]);
    if (std::abs(q.norm() - 1.0) > 1e-6) refuse(key, "a unit quaternion and a place");
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = q.normalized().toRotationMatrix();
    pose.translation() << n[4], n[5], n[6];
    return pose;
  }
  [[nodiscard]] const json& array(const char* key) const {
    const json& value = at(key, "an array");
    if (!value.is_array()) refuse(key, "an array");
    return value;
  }

 private:
  const json& value_;
  std::string file_, place_;
};

Measurement measurement_of(const Reader& reader) {
  Measurement measurement;
  const auto camera = reader.numbers("camera_rad", 6, 100.0), target = reader.numbers("target_rad", 6, 100.0);
  std::ranges::copy(camera, measurement.posture.camera_rad.begin());
  std::ranges::copy(target, measurement.posture.target_rad.begin());
  measurement.posture.carriage_m = reader.number("carriage_m", -100.0, 100.0);
  for (const json& element : reader.array("corners")) {
    const auto numbers = reader.numbers(element, "corners", 3, 1e5);
    if (numbers[0] != std::floor(numbers[0]) || numbers[0] < 0.0 || numbers[0] > 1000.0)
      reader.refuse("corners", "the number of a corner first");
    measurement.corners.push_back({static_cast<int>(numbers[0]), {numbers[1], numbers[2]}});
  }
  if (reader.has("vicon_camera"))
    measurement.vicon = ViconObjects{reader.pose("vicon_camera"), reader.pose("vicon_target")};
  return measurement;
}

std::vector<Measurement> measurements_of(const Reader& document, const char* key, const std::string& file) {
  std::vector<Measurement> measurements;
  for (const json& element : document.array(key))
    measurements.push_back(measurement_of(Reader(element, file, fmt::format("{}[{}]", key, measurements.size()))));
  return measurements;
}

CalibrationData data_of(const json& value, const std::string& file) {
  const Reader document(value, file, "");
  if (document.text("format") != kFormat) document.refuse("format", fmt::format("\"{}\"", kFormat));
  CalibrationData data;
  CalibrationValidity& validity = data.validity;
  validity.date_utc = document.text("date_utc");
  validity.bench = document.text("bench");
  const json& emulated = document.at("emulated", "true or false");
  if (!emulated.is_boolean()) document.refuse("emulated", "true or false");
  validity.emulated = emulated.get<bool>();
  const json& seed = document.at("seed", "a whole number from 0");
  if (!seed.is_number_unsigned()) document.refuse("seed", "a whole number from 0");
  validity.seed = seed.get<std::uint64_t>();
  validity.camera_model = document.text("camera_model");
  validity.camera_serial = document.text("camera_serial");
  data.width_px = static_cast<int>(document.number("width_px", 16, 65535));
  data.height_px = static_cast<int>(document.number("height_px", 16, 65535));
  data.bits = static_cast<int>(document.number("bits", 8, 16));
  data.dark.offset_dn = document.number("offset_dn", 0.0, 65535.0);
  data.dark.read_noise_dn = document.number("read_noise_dn", 0.0, 65535.0);
  for (const json& element : document.array("lights")) {
    const Reader light(element, file, fmt::format("lights[{}]", data.lights.size()));
    data.lights.push_back({light.text("source"), light.number("level", 0.0, 1.0), light.number("dn_per_s", -1e12, 1e12),
                           light.number("design_irradiance", 0.0, 1e6)});
  }
  data.fitted = measurements_of(document, "fitted", file);
  data.judged = measurements_of(document, "judged", file);
  return data;
}

void append(std::string& text, const char* key, const std::vector<Measurement>& measurements) {
  text += fmt::format("\"{}\": [", key);
  for (std::size_t k = 0; k < measurements.size(); ++k)
    text += (k == 0 ? "\n" : ",\n") + json_of(measurements[k]).dump();
  text += "\n]";
}

std::string text_of_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot be read", file.string()));
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

std::string text_of(const CalibrationData& data) {
  const CalibrationValidity& validity = data.validity;
  std::string text = "{\n";
  const auto key = [&](const char* name, const json& value) {
    text += fmt::format("\"{}\": {},\n", name, value.dump(-1, ' ', false, json::error_handler_t::replace));
  };
  key("format", kFormat);
  key("date_utc", validity.date_utc);
  key("bench", validity.bench);
  key("emulated", validity.emulated);
  key("seed", validity.seed);
  key("camera_model", validity.camera_model);
  key("camera_serial", validity.camera_serial);
  key("width_px", data.width_px);
  key("height_px", data.height_px);
  key("bits", data.bits);
  key("offset_dn", data.dark.offset_dn);
  key("read_noise_dn", data.dark.read_noise_dn);
  json lights = json::array();
  for (const LightSample& sample : data.lights)
    lights.push_back({{"source", sample.source},
                      {"level", sample.level},
                      {"dn_per_s", sample.dn_per_s},
                      {"design_irradiance", sample.design_irradiance}});
  key("lights", lights);
  append(text, "fitted", data.fitted);
  text += ",\n";
  append(text, "judged", data.judged);
  return text + "\n}\n";
}

void save_data(const CalibrationData& data, const std::filesystem::path& file) {
  const std::filesystem::path partial = file.string() + ".partial";
  errno = 0;
  {
    std::ofstream out(partial, std::ios::binary);
    out << text_of(data);
    out.flush();
    if (!out) throw files::write_error(file);
  }
  std::filesystem::rename(partial, file);
}

CalibrationData parse_data(std::string_view text, const std::string& file) {
  json document;
  try {
    document = json::parse(text);
  } catch (const json::exception& error) {
    throw std::runtime_error(fmt::format("{}: not the data of a calibration: {}", file, error.what()));
  }
  return data_of(document, file);
}

CalibrationData load_data(const std::filesystem::path& file) {
  return parse_data(text_of_file(file), file.string());
}

// True poses of an emulator for measurements.

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
/// The table has the true axes, which repeat within some thousandths of a degree.
constexpr double kSameJoint_rad = 0.02 * kDegree, kSamePlace_m = 5e-4;

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

class TruthRows {
 public:
  explicit TruthRows(const std::filesystem::path& file) : file_(file.string()), stream_(file) {
    std::string header;
    if (!stream_ || !std::getline(stream_, header))
      throw std::runtime_error(fmt::format("{}: not a table of true poses", file_));
    const auto names = cells_of(header);
    for (std::size_t k = 0; k < names.size(); ++k) columns_[names[k]] = k;
  }

  bool next() {
    std::string line;
    do {
      if (!std::getline(stream_, line)) return false;
      ++line_;
    } while (line.empty());
    cells_ = cells_of(line);
    return true;
  }

  [[nodiscard]] const std::string& text(const std::string& column) const {
    const auto found = columns_.find(column);
    if (found == columns_.end() || found->second >= cells_.size())
      throw std::runtime_error(fmt::format("{}:{}: column {} is missing", file_, line_, column));
    return cells_[found->second];
  }

  [[nodiscard]] double number(const std::string& column) const {
    const std::string& cell = text(column);
    const auto value = files::number_of(cell);
    if (!value)
      throw std::runtime_error(
          fmt::format("{}:{}: column {}: {} is not a finite number", file_, line_, column, files::quoted(cell)));
    return *value;
  }

 private:
  std::string file_;
  std::ifstream stream_;
  std::map<std::string, std::size_t> columns_;
  std::vector<std::string> cells_;
  int line_ = 1;
};

Posture posture_of(const TruthRows& rows) {
  Posture posture;
  for (int k = 0; k < 6; ++k) {
    posture.camera_rad[k] = kDegree * rows.number(fmt::format("camera_A{}_deg", k + 1));
    posture.target_rad[k] = kDegree * rows.number(fmt::format("target_A{}_deg", k + 1));
  }
  posture.carriage_m = rows.number("carriage_m");
  return posture;
}

bool is_same(const Posture& a, const Posture& b) {
  return (a.camera_rad - b.camera_rad).cwiseAbs().maxCoeff() < kSameJoint_rad &&
         (a.target_rad - b.target_rad).cwiseAbs().maxCoeff() < kSameJoint_rad &&
         std::abs(a.carriage_m - b.carriage_m) < kSamePlace_m;
}

}  // namespace

int add_truth(std::vector<Measurement>& measurements, const std::filesystem::path& truth,
              const Eigen::Isometry3d& T_target_board) {
  TruthRows rows(truth);
  int found = 0;
  while (rows.next()) {
    if (rows.text("mounted") != "board") continue;
    const Posture posture = posture_of(rows);
    for (Measurement& measurement : measurements) {
      if (measurement.true_T_C_T || !is_same(posture, measurement.posture)) continue;
      const Eigen::Quaterniond q(rows.number("q_C_T_w"), rows.number("q_C_T_x"), rows.number("q_C_T_y"),
                                 rows.number("q_C_T_z"));
      Eigen::Isometry3d T_C_B = Eigen::Isometry3d::Identity();
      T_C_B.linear() = q.normalized().toRotationMatrix();
      T_C_B.translation() << rows.number("C_x_m"), rows.number("C_y_m"), rows.number("C_z_m");
      measurement.true_T_C_T = T_C_B * T_target_board.inverse();
      ++found;
    }
  }
  return found;
}

}  // namespace vbar::tron::calibrate
