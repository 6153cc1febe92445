#include "host_sim/report/ephemeris_csv.h"

#include <string>

#include "host_sim/report/csv_table.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::report {
namespace {

constexpr double kDegreesPerRadian = 180.0 / 3.14159265358979323846;

}  // namespace

EphemerisCsv::EphemerisCsv(const std::filesystem::path& file) : file_(file) {
  file_.append(
      "time_s,utc,position_eci_x_m,position_eci_y_m,position_eci_z_m,velocity_eci_x_mps,velocity_eci_y_mps,"
      "velocity_eci_z_mps,latitude_deg,longitude_deg,altitude_m\n");
}

void EphemerisCsv::append(const EphemerisRow& row) {
  std::string line;
  append_value(line, row.time_s);
  line += ',';
  line += truth::format_utc(row.time);
  const auto add = [&](double value) {
    line += ',';
    append_value(line, value);
  };
  for (const double component : row.state.position_eci) add(component);
  for (const double component : row.state.velocity_eci) add(component);
  add(kDegreesPerRadian * row.geodetic.latitude);
  add(kDegreesPerRadian * row.geodetic.longitude);
  add(row.geodetic.altitude);
  line += '\n';
  file_.append(line);
}

}  // namespace vbar::report
