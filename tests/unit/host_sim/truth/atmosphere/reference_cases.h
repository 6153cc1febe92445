#pragma once
// Reference outputs of NRLMSISE-00 as the tests read them: rows of named columns.

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_sim/truth/atmosphere/nrlmsise00.h"
#include "tests/support/paths.h"

namespace vbar::truth::test {

using ReferenceRow = std::map<std::string, std::string>;

inline std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> result;
  std::stringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) result.push_back(cell);
  return result;
}

inline std::vector<ReferenceRow> reference_rows(const std::string& file_name) {
  const auto file = std::filesystem::path(vbar::tests::source_path("tests/unit/host_sim/truth/atmosphere")) / file_name;
  std::ifstream in(file);
  std::vector<std::string> columns;
  std::vector<ReferenceRow> rows;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#')) continue;
    const auto words = cells(line);
    if (columns.empty()) {
      columns = words;
      continue;
    }
    ReferenceRow row;
    for (std::size_t i = 0; i < columns.size(); ++i) row[columns[i]] = words.at(i);
    rows.push_back(row);
  }
  if (rows.empty()) throw std::runtime_error("no reference rows in " + file.string());
  return rows;
}

inline double number(const ReferenceRow& row, const std::string& column) {
  return std::stod(row.at(column));
}

inline AtmosphereInput input_of(const ReferenceRow& row) {
  AtmosphereInput input;
  input.day_of_year = std::stoi(row.at("doy"));
  input.ut_s = number(row, "sec");
  input.altitude_km = number(row, "alt_km");
  input.latitude_deg = number(row, "lat_deg");
  input.longitude_deg = number(row, "lon_deg");
  input.local_solar_time_h = number(row, "lst_h");
  input.indices.f107_average = number(row, "f107A");
  input.indices.f107 = number(row, "f107");
  input.indices.ap_daily = number(row, "ap");
  if (row.at("sw9") == "-1") {
    input.indices.geomagnetic_index = GeomagneticIndex::kThreeHourly;
    input.indices.ap_history.fill(100.0);  // "100x7": the daily value and the six of the history
  }
  return input;
}

inline std::shared_ptr<const Nrlmsise00Tables> published_tables() {
  static const auto tables = std::make_shared<const Nrlmsise00Tables>(
      load_nrlmsise00_tables(std::filesystem::path(vbar::tests::source_path("data/atmosphere/nrlmsise00.csv"))));
  return tables;
}

/// Outputs by the names of the reference files' columns, in the model's own units: 1/cm^3, g/cm^3, K.
inline std::map<std::string, double> outputs(const AtmosphereState& state) {
  const SpeciesDensities& n = state.per_m3;
  return {{"HE", 1e-6 * n.he},
          {"O", 1e-6 * n.o},
          {"N2", 1e-6 * n.n2},
          {"O2", 1e-6 * n.o2},
          {"AR", 1e-6 * n.ar},
          {"H", 1e-6 * n.h},
          {"N", 1e-6 * n.n},
          {"ANOM_O", 1e-6 * n.anomalous_o},
          {"RHO", 1e-3 * state.density},
          {"RHO_g_cm3", 1e-3 * state.density},
          {"RHO_gtd7d_g_cm3", 1e-3 * state.drag_density},
          {"TEXO_K", state.exospheric_temperature},
          {"TALT_K", state.temperature}};
}

}  // namespace vbar::truth::test
