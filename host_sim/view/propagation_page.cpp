
#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fsw/core/gps_time.h"
#include "fsw/orbit/rtn.h"
#include "host_sim/files/output_file.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/view/embedded_table.h"
#include "host_sim/view/view_page.h"

namespace vbar::view {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kMaxSpacecraft = 50;         // in the page; the first ones
constexpr std::size_t kMaxPageTables = 4'200'000;  // bytes as base64: the page is shorter than 5 MB
constexpr std::array kColumns{"time_s",
                              "utc",
                              "position_eci_x_m",
                              "position_eci_y_m",
                              "position_eci_z_m",
                              "velocity_eci_x_mps",
                              "velocity_eci_y_mps",
                              "velocity_eci_z_mps",
                              "latitude_deg",
                              "longitude_deg",
                              "altitude_m"};
constexpr std::size_t kUtc = 1, kPosition = 2, kVelocity = 5;

fs::path record_of(const fs::path& folder) {
  return folder / "propagation.json";
}

const char* meaning_of(std::string_view column) {
  if (column == "time_s") return "s, since the epoch of the mission";
  if (column.starts_with("position_eci") || column.starts_with("velocity_eci")) return "GCRF";
  return "WGS 84";
}

/// The ephemeris of a spacecraft, read part by part; times in UTC are left out, as the page has the epoch.
class Ephemeris {
 public:
  Ephemeris(const fs::path& folder, const std::string& name) : file_(folder / (name + ".csv")), stream_(file_) {
    if (!stream_) throw std::runtime_error(fmt::format("{}: cannot be read", file_.string()));
    std::vector<std::string> head;
    if (!next_line(head) || !std::ranges::equal(head, kColumns))
      fail(fmt::format("the first line is not that of an ephemeris; accepted: {}", fmt::join(kColumns, ",")));
    for (std::size_t k = 0; k < kColumns.size(); ++k)
      if (k != kUtc) part_.columns.push_back({kColumns[k], meaning_of(kColumns[k]), {}});
    kept_ = part_;
    kept_.file = file_.filename().string();
  }

  /// Reads the following rows, at most `count`; returns how many there were.
  std::size_t read(std::size_t count) {
    for (CellColumn& column : part_.columns) column.cells.clear();
    states_.clear();
    std::vector<std::string> cells;
    while (states_.size() < count && next_line(cells)) {
      if (cells.size() != kColumns.size())
        fail(fmt::format("found {} cells; accepted: {}", cells.size(), kColumns.size()));
      if (first_utc_.empty()) first_utc_ = cells[kUtc], first_time_ = cells[0];
      states_.push_back(state_of(cells));
      for (std::size_t k = 0, column = 0; k < cells.size(); ++k)
        if (k != kUtc) part_.columns[column++].cells.push_back(std::move(cells[k]));
    }
    return states_.size();
  }

  [[nodiscard]] CellTable& part() { return part_; }
  [[nodiscard]] CellTable& kept() { return kept_; }
  [[nodiscard]] const std::vector<fsw::orbit::CartesianState>& states() const { return states_; }
  /// The epoch of the mission, from both times of the first row.
  [[nodiscard]] std::string epoch_utc() const {
    double time_s = 0.0;
    if (!report::read_value(first_time_, time_s) || first_utc_.empty()) fail("has no row with a time");
    return truth::format_utc(truth::gps_from_utc(first_utc_) - fsw::nearest_duration(time_s));
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(fmt::format("{}, line {}: {}", file_.string(), line_, what));
  }

 private:
  bool next_line(std::vector<std::string>& cells) {
    ++line_;
    return std::getline(stream_, text_) && report::split_cells(text_, cells);
  }

  fsw::orbit::CartesianState state_of(const std::vector<std::string>& cells) const {
    fsw::orbit::CartesianState state;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      for (const auto& [cell, value] : {std::pair(&cells[kPosition + k], &state.position_eci[axis]),
                                        std::pair(&cells[kVelocity + k], &state.velocity_eci[axis])})
        if (cell->empty() || !report::read_value(*cell, *value))
          fail(fmt::format("found '{}'; accepted: a number", *cell));
    }
    return state;
  }

  fs::path file_;
  std::ifstream stream_;
  std::string text_, first_time_, first_utc_;
  std::size_t line_ = 0;
  CellTable part_, kept_;
  std::vector<fsw::orbit::CartesianState> states_;
};

/// The motion of the second spacecraft in the RTN frame of the first one, as the table "truth" of a run has it.
CellTable relative_motion() {
  CellTable table{"", {{"time_s", "s, since the epoch of the mission", {}}}, "truth"};
  const auto add = [&](const char* stem, std::array<const char*, 3> axes, const char* unit, const char* meaning) {
    for (const char* const axis : axes)
      table.columns.push_back({fmt::format("{}_{}_{}", stem, axis, unit), meaning, {}});
  };
  add("relative_position_rtn", {"r", "t", "n"}, "m", "of the second spacecraft, in the RTN frame of the first one");
  add("relative_velocity_rtn", {"r", "t", "n"}, "mps", "of the second spacecraft, in the RTN frame of the first one");
  add("servicer_position_eci", {"x", "y", "z"}, "m", "of the first spacecraft, GCRF");
  add("servicer_velocity_eci", {"x", "y", "z"}, "mps", "of the first spacecraft, GCRF");
  return table;
}

CellTable relative_part(Ephemeris& chief, const Ephemeris& deputy) {
  CellTable part = relative_motion();
  part.columns[0].cells = chief.part().columns[0].cells;
  for (std::size_t row = 0; row < chief.states().size(); ++row) {
    const fsw::orbit::RelativeState relative =
        fsw::orbit::relative_state_rtn(chief.states()[row], deputy.states()[row]);
    std::size_t column = 1;
    for (const fsw::Vector3& vector : {relative.position_rtn, relative.velocity_rtn})
      for (const double value : vector) part.columns[column++].cells.push_back(fmt::format("{}", value));
    // The state of the first spacecraft follows the time in its own table.
    for (std::size_t k = 1; k <= 6; ++k) part.columns[column++].cells.push_back(chief.part().columns[k].cells[row]);
  }
  return part;
}

/// Appends rows of a part: all, or those in which a column has its extremes, and both ends.
void keep(const CellTable& part, bool all, CellTable& kept) {
  for (const std::size_t row : rows_to_keep(part, all ? part.rows() : 1))
    for (std::size_t k = 0; k < kept.columns.size(); ++k) kept.columns[k].cells.push_back(part.columns[k].cells[row]);
  kept.rows_of_file += part.rows();
}

std::size_t count_rows(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> block(1 << 20);
  std::size_t lines = 0;
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0)
    lines += static_cast<std::size_t>(std::count(block.begin(), block.begin() + stream.gcount(), '\n'));
  return lines > 0 ? lines - 1 : 0;
}

/// Returns the tables of the page: the relative motion, if there are two spacecraft, and all ephemerides.
std::vector<CellTable> tables_of(std::vector<Ephemeris>& all, std::size_t rows) {
  const std::size_t most = std::clamp<std::size_t>(5 * kMaxRows / all.size(), 200, kMaxRows);
  CellTable motion = relative_motion();
  const bool is_short = rows <= most;
  // Each part gives at most its ends and both extremes of each column.
  const std::size_t parts = std::max<std::size_t>(most / (2 * motion.columns.size() + 2), 1);
  const std::size_t rows_of_part = is_short ? std::max<std::size_t>(rows, 1) : (rows + parts - 1) / parts;
  while (const std::size_t count = all.front().read(rows_of_part)) {
    for (Ephemeris& other : std::span(all).subspan(1))
      if (other.read(rows_of_part) != count) other.fail("has fewer rows than the ephemeris of the first spacecraft");
    for (Ephemeris& one : all) keep(one.part(), is_short, one.kept());
    if (all.size() > 1) keep(relative_part(all[0], all[1]), is_short, motion);
  }
  std::vector<CellTable> tables;
  if (all.size() > 1) tables.push_back(std::move(motion));
  for (Ephemeris& one : all) tables.push_back(std::move(one.kept()));
  return tables;
}

/// Names of the spacecraft of a complete propagation.
std::vector<std::string> spacecraft_of(const fs::path& file, const json& record) {
  if (!record.is_object() || !record.contains("spacecraft") || !record["spacecraft"].is_array())
    throw std::runtime_error(fmt::format("{}: is not that of a propagation", file.string()));
  if (!record.value("complete", false))
    throw std::runtime_error(fmt::format("{}: the propagation is incomplete; accepted: a complete one", file.string()));
  std::vector<std::string> names;
  for (const json& one : record["spacecraft"]) names.push_back(one.value("name", ""));
  for (const std::string& name : names)
    if (name.empty() || fs::path(name).filename() != name)
      throw std::runtime_error(fmt::format("{}: spacecraft.name: found '{}'; accepted: a name", file.string(), name));
  if (names.empty()) throw std::runtime_error(fmt::format("{}: has no spacecraft", file.string()));
  return names;
}

}  // namespace

bool is_propagation(const fs::path& folder) {
  return fs::is_regular_file(record_of(folder)) && !fs::exists(folder / "summary.json");
}

std::string propagation_page(const fs::path& folder, std::string_view name) {
  const json record = json::parse(files::read_text_file(record_of(folder)), nullptr, false);
  std::vector<std::string> names = spacecraft_of(record_of(folder), record);
  const std::size_t count = names.size();
  names.resize(std::min(count, kMaxSpacecraft));
  std::vector<Ephemeris> all;
  for (const std::string& one : names) all.emplace_back(folder, one);
  const std::vector<CellTable> tables = tables_of(all, count_rows(folder / (names.front() + ".csv")));
  json scene{{"epoch_utc", all.front().epoch_utc()}, {"bodies", {{"servicer", {{"name", names.front()}}}}}};
  if (names.size() > 1) scene["bodies"]["target"] = {{"name", names[1]}};
  const json page{
      {"name", name},
      {"kind", "propagation"},
      {"summary", {{"mission", record.value("mission", "")}, {"complete", true}, {"verdict", "propagated"}}},
      {"spacecraft", names},
      {"tables", embedded(tables, kMaxPageTables)},
      {"pictures", json::array()},
      {"scene", std::move(scene)},
      {"note",
       count > names.size() ? fmt::format("the page has the first {} of {} spacecraft", names.size(), count) : ""}};
  return filled_page(name, json::array({page}));
}

}  // namespace vbar::view
