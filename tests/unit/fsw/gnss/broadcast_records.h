#pragma once
// Real broadcast ephemerides and their satellites' states by RTKLIB (tests/data/receiver/broadcast_*.csv, written by
// tests/peers/rtklib/satellite_states.py).

#include <array>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "fsw/gnss/ephemeris.h"

namespace vbar::fsw::gnss::test {

inline std::vector<std::vector<std::string>> csv_rows(const std::string& name) {
  std::ifstream file(VBAR_SOURCE_DIR "/tests/data/receiver/" + name);
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(file, line);  // the source
  std::getline(file, line);  // the columns
  while (std::getline(file, line)) {
    std::istringstream stream(line);
    rows.emplace_back();
    for (std::string cell; std::getline(stream, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

inline std::vector<Ephemeris> broadcast_records() {
  std::vector<Ephemeris> records;
  for (const auto& row : csv_rows("broadcast_records.csv")) {
    Ephemeris e;
    e.satellite.constellation = row[0] == "G"   ? Constellation::kGps
                                : row[0] == "E" ? Constellation::kGalileo
                                                : Constellation::kBeidou;
    e.satellite.prn = static_cast<std::uint8_t>(std::stoi(row[1]));
    e.issue = std::stoi(row[2]);
    e.healthy = row[3] == "1";
    e.toe.ns = std::stoll(row[4]);
    e.toc.ns = std::stoll(row[5]);
    const std::array<double*, 20> fields{&e.sqrt_a,        &e.e,   &e.m0,    &e.delta_n, &e.omega0,
                                         &e.omega_dot,     &e.i0,  &e.i_dot, &e.omega,   &e.cuc,
                                         &e.cus,           &e.cic, &e.cis,   &e.crc,     &e.crs,
                                         &e.toe_of_week_s, &e.af0, &e.af1,   &e.af2,     &e.group_delay_s};
    for (std::size_t k = 0; k < fields.size(); ++k) *fields[k] = std::stod(row[6 + k]);
    records.push_back(e);
  }
  return records;
}

struct ReferenceState {
  std::size_t record = 0;
  GpsTime time;
  std::array<double, 8> values{};  ///< position, velocity (Earth-fixed; m, m/s), clock, drift
};

inline std::vector<ReferenceState> broadcast_states() {
  std::vector<ReferenceState> states;
  for (const auto& row : csv_rows("broadcast_states.csv")) {
    ReferenceState state;
    state.record = std::stoul(row[0]);
    state.time.ns = std::stoll(row[1]);
    for (std::size_t k = 0; k < state.values.size(); ++k) state.values[k] = std::stod(row[2 + k]);
    states.push_back(state);
  }
  return states;
}

}  // namespace vbar::fsw::gnss::test
