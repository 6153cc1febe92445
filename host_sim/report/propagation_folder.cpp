#include "host_sim/report/propagation_folder.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/files/output_file.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/run_folder.h"
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

namespace {

/// A Hermite polynomial of degree 2n - 1 goes through n states with their velocities.
constexpr std::size_t kMostStates = 4;

std::string epoch_text(fsw::GpsTime time, int decimals) {
  std::string text = truth::format_utc(time, decimals);
  text.pop_back();  // the "Z": TIME_SYSTEM says it
  return text;
}

}  // namespace

OemFile::OemFile(const std::filesystem::path& file, const std::string& object, const Span& span) : file_(file) {
  std::string head = fmt::format(
      "CCSDS_OEM_VERS = 2.0\n"
      "CREATION_DATE = {}\n"
      "ORIGINATOR = VBAR\n"
      "\n"
      "META_START\n"
      "OBJECT_NAME = {}\n"
      "OBJECT_ID = {}\n"
      "CENTER_NAME = EARTH\n"
      "REF_FRAME = GCRF\n"
      "TIME_SYSTEM = UTC\n"
      "START_TIME = {}\n"
      "STOP_TIME = {}\n",
      epoch_text(span.created, 0), object, object, epoch_text(span.start, 9), epoch_text(span.stop, 9));
  if (span.states > 1) {
    head +=
        fmt::format("INTERPOLATION = HERMITE\nINTERPOLATION_DEGREE = {}\n", 2 * std::min(span.states, kMostStates) - 1);
  }
  file_.append(head + "META_STOP\n\n");
}

void OemFile::append(const EphemerisRow& row) {
  const fsw::Vector3 r = 1e-3 * row.state.position_eci, v = 1e-3 * row.state.velocity_eci;
  file_.append(fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", epoch_text(row.time, 9), r.x(), r.y(),
                           r.z(), v.x(), v.y(), v.z()));
}

namespace {

using Json = nlohmann::ordered_json;

std::string spacecraft_table(const PropagationRecord& record) {
  std::size_t width = std::string_view("spacecraft").size();
  for (const PropagatedSpacecraft& one : record.spacecraft) width = std::max(width, one.name.size());
  constexpr auto kHead = "{:<{}} {:>12} {:>12} {:>12} {:>9} {:>9} {:>12} {:>8}\n";
  std::string text =
      fmt::format(kHead, "", width, "first alt.", "last alt.", "a by drag", "", "rejected", "force", "shadow");
  text += fmt::format(kHead, "spacecraft", width, "km", "km", "m", "steps", "steps", "evaluations", "edges");
  for (const PropagatedSpacecraft& one : record.spacecraft) {
    const truth::TruthStatistics& s = one.statistics;
    text += fmt::format(kHead, one.name, width, fixed(1e-3 * one.first_altitude_m, 3),
                        fixed(1e-3 * one.last_altitude_m, 3), fixed(one.semi_major_axis_change_by_drag_m, 2), s.steps,
                        s.rejected_steps, s.force_evaluations, s.edges_crossed);
  }
  return text;
}

/// Times of the forces, and of one thread alone what is left: integrator, orbit geometry, shadow edges.
std::vector<truth::ForceTime> shares_of(const PropagationRecord& record) {
  std::vector<truth::ForceTime> shares = record.force_times;
  double sum_s = 0.0;
  for (const truth::ForceTime& share : shares) sum_s += share.wall_s;
  if (record.threads == 1 && record.total.wall_s > sum_s) {
    shares.push_back({"integration", record.total.wall_s - sum_s});
  }
  return shares;
}

std::string force_table(const PropagationRecord& record) {
  const std::vector<truth::ForceTime> shares = shares_of(record);
  double sum_s = 0.0;
  for (const truth::ForceTime& share : shares) sum_s += share.wall_s;
  if (!(sum_s > 0.0) || record.total.force_evaluations == 0) return {};
  std::string text = fmt::format("{:<20} {:>9} {:>9} {:>14}\n", "where the time goes", "s", "%", "ns/evaluation");
  for (const truth::ForceTime& share : shares) {
    text += fmt::format("{:<20} {:>9.3f} {:>9.1f} {:>14.0f}\n", share.force, share.wall_s, 100.0 * share.wall_s / sum_s,
                        1e9 * share.wall_s / static_cast<double>(record.total.force_evaluations));
  }
  return text;
}

double speed_factor(const PropagationRecord& record) {
  return record.wall_s > 0.0 ? record.simulated_s / record.wall_s : 0.0;
}

Json json_of(const PropagatedSpacecraft& one) {
  return {{"name", one.name},
          {"first_altitude_m", one.first_altitude_m},
          {"last_altitude_m", one.last_altitude_m},
          {"semi_major_axis_change_by_drag_m",
           one.semi_major_axis_change_by_drag_m ? Json(*one.semi_major_axis_change_by_drag_m) : Json(nullptr)},
          {"steps", one.statistics.steps},
          {"rejected_steps", one.statistics.rejected_steps},
          {"force_evaluations", one.statistics.force_evaluations},
          {"shadow_edges", one.statistics.edges_crossed}};
}

}  // namespace

std::string propagation_table(const PropagationRecord& record) {
  std::string notes;
  for (const std::string& note : record.data_notes) notes += fmt::format("data       {}\n", note);
  return fmt::format("{}\n{}\n{}{} of {} spacecraft on {} thread{} in {:.3g} s: {} times real time\n",
                     spacecraft_table(record), force_table(record), notes, duration_text(record.simulated_s),
                     record.spacecraft.size(), record.threads, record.threads == 1 ? "" : "s", record.wall_s,
                     grouped_nearest(speed_factor(record)));
}

std::string propagation_json(const PropagationRecord& record, std::span<const std::string> files) {
  Json spacecraft = Json::array();
  for (const PropagatedSpacecraft& one : record.spacecraft) spacecraft.push_back(json_of(one));
  Json times = Json::object();
  for (const truth::ForceTime& share : shares_of(record)) times[std::string(share.force)] = share.wall_s;
  const Json json{
      {"mission", record.mission},
      {"complete", record.complete},
      {"incomplete_reason", record.incomplete_reason.empty() ? Json(nullptr) : Json(record.incomplete_reason)},
      {"simulated_s", record.simulated_s},
      {"wall_s", record.wall_s},
      {"speed_factor", speed_factor(record)},
      {"threads", record.threads},
      {"spacecraft", std::move(spacecraft)},
      {"force_wall_s", std::move(times)},
      {"data_notes", record.data_notes},
      {"files", files}};
  return json.dump(2) + "\n";
}

namespace {

namespace fs = std::filesystem;

constexpr const char* kSummary = "propagation.json";

[[noreturn]] void fail(const fs::path& folder, std::string_view what) {
  throw std::runtime_error(fmt::format("{}: {}", folder.string(), what));
}

/// The files of the propagation that `folder` holds.
std::vector<std::string> files_left(const fs::path& folder) {
  if (!fs::is_regular_file(folder / kSummary))
    fail(folder, "holds something other than a propagation; remove it or name another folder with --out");
  const auto json = nlohmann::json::parse(files::read_text_file(folder / kSummary), nullptr, false);
  if (!json.is_object() || !json.contains("files")) fail(folder / kSummary, "is not that of a propagation");
  return json.at("files").get<std::vector<std::string>>();
}

void clear(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) fail(folder, "is a file; a propagation needs a folder");
  if (fs::is_empty(folder)) return;
  for (const std::string& name : files_left(folder)) {
    if (fs::path(name).filename() != name) fail(folder / kSummary, "lists a file outside its folder");
    fs::remove(folder / name);
    fs::remove(files::PartialFile::part_of(folder / name));
  }
  fs::remove(view_file(folder));
}

}  // namespace

fs::path default_propagation_folder(const std::string& mission) {
  return fs::path("runs") / (mission + "-truth");
}

PropagationFolder::PropagationFolder(fs::path folder, const std::string& mission) : folder_(std::move(folder)) {
  try {
    clear(folder_);
    fs::create_directories(folder_);
  } catch (const fs::filesystem_error& error) {
    fail(folder_, "cannot be made: " + error.code().message());
  }
  PropagationRecord running;
  running.mission = mission;
  running.incomplete_reason = "running";
  files::replace_text_file(folder_ / kSummary, propagation_json(running, file_names_));
}

void PropagationFolder::start_files(std::span<const std::string> names, const OemFile::Span* oem) {
  for (const std::string& name : names) {
    file_names_.push_back(name + ".csv");
    csv_.emplace_back(folder_ / file_names_.back());
    if (oem == nullptr) continue;
    file_names_.push_back(name + ".oem");
    oem_.emplace_back(folder_ / file_names_.back(), name, *oem);
  }
}

void PropagationFolder::append(std::size_t spacecraft, const EphemerisRow& row) {
  csv_.at(spacecraft).append(row);
  if (!oem_.empty()) oem_.at(spacecraft).append(row);
}

void PropagationFolder::finish(const PropagationRecord& record) {
  const auto end = [&](auto& ephemerides) {
    for (auto& file : ephemerides) record.complete ? file.finish() : file.flush();
    ephemerides.clear();
  };
  try {
    end(csv_);
    end(oem_);
  } catch (const std::runtime_error&) {
    if (record.complete) throw;  // otherwise the record states a reason already
  }
  files::replace_text_file(folder_ / kSummary, propagation_json(record, file_names_));
}

}  // namespace vbar::report
