#include "host_sim/report/propagation_summary.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/report/number_text.h"

namespace vbar::report {
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

}  // namespace vbar::report
