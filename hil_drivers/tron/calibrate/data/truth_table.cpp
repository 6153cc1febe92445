// True poses of an emulator for measurements.

#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "hil_drivers/tron/calibrate/data/calibration_data.h"
#include "host_sim/files/text_lines.h"

namespace vbar::tron::calibrate {
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
