#pragma once
// Real broadcast ephemerides and their satellites' states by RTKLIB (tests/data/receiver/broadcast_*.csv, written by
// tests/peers/rtklib/satellite_states.py).

#include <array>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "fsw/gnss/ephemeris.h"
#include "tests/support/paths.h"

namespace vbar::fsw::gnss::test {

inline std::vector<std::vector<std::string>> csv_rows(const std::string& name) {
  std::ifstream file(vbar::tests::source_path("tests/data/receiver/") + name);
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

/// Every number of an ephemeris, in the order of the CSV file's columns.
inline constexpr std::array<double Ephemeris::*, 20> kEphemerisNumbers{
    &Ephemeris::sqrt_a,        &Ephemeris::e,   &Ephemeris::m0,    &Ephemeris::delta_n, &Ephemeris::omega0,
    &Ephemeris::omega_dot,     &Ephemeris::i0,  &Ephemeris::i_dot, &Ephemeris::omega,   &Ephemeris::cuc,
    &Ephemeris::cus,           &Ephemeris::cic, &Ephemeris::cis,   &Ephemeris::crc,     &Ephemeris::crs,
    &Ephemeris::toe_of_week_s, &Ephemeris::af0, &Ephemeris::af1,   &Ephemeris::af2,     &Ephemeris::group_delay_s};

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
    for (std::size_t k = 0; k < kEphemerisNumbers.size(); ++k) e.*kEphemerisNumbers[k] = std::stod(row[6 + k]);
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
