#include "host_sim/report/summary_json.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "host_sim/report/text_file.h"

namespace vbar::report {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no NaN: a number that is not finite is written as null, by nlohmann itself for plain ones.
Json json_of(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json json_of(const std::optional<MeanAndDeviation>& value) {
  if (!value) return {{"mean", nullptr}, {"std", nullptr}};
  return {{"mean", value->mean}, {"std", value->std}};
}

Json json_of(const std::optional<BearingError>& value) {
  if (!value) return {{"mean", nullptr}, {"std", nullptr}, {"bias", nullptr}};
  return {{"mean", value->mean}, {"std", value->std}, {"bias", value->bias}};
}

Json json_of(const std::optional<PoseFigures>& value) {
  if (!value) return nullptr;
  return {{"images", value->images},
          {"with_pose", value->with_pose},
          {"poses_over_10_deg", value->poses_over_10_deg},
          {"keypoint_error_px", value->keypoint_error_px},
          {"keypoint_chi_square", value->keypoint_chi_square},
          {"lit_navigation_error_m",
           {{"mean", value->lit_navigation_error_m.mean}, {"std", value->lit_navigation_error_m.std}}},
          {"attitude_nees", json_of(value->attitude_nees)},
          {"attitude_restarts", value->attitude_restarts},
          {"restarts", value->restarts}};
}

Json count_or_null(const std::optional<ImageCounts>& counts, int ImageCounts::*count) {
  return counts ? Json((*counts).*count) : Json(nullptr);
}

Json text_or_null(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

Json json_of(const WaypointRow& row) {
  return {{"index", row.index},
          {"time_s", row.time_s},
          {"navigation_error_m", json_of(row.navigation_error_m)},
          {"navigation_velocity_error_mps", json_of(row.navigation_velocity_error_mps)},
          {"control_error_m", row.control_error_m},
          {"leg_dv_mps", row.leg_dv_mps},
          {"cumulative_dv_mps", row.cumulative_dv_mps},
          {"leg_maneuvers", row.leg_maneuvers}};
}

double number(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

std::string text(const Json& json) {
  return json.is_null() ? std::string() : json.get<std::string>();
}

std::optional<double> optional_number(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return json.get<double>();
}

std::optional<MeanAndDeviation> mean_and_deviation(const Json& json) {
  if (json.at("mean").is_null()) return std::nullopt;
  return MeanAndDeviation{number(json.at("mean")), number(json.at("std"))};
}

std::optional<BearingError> bearing_error(const Json& json) {
  if (json.at("mean").is_null()) return std::nullopt;
  return BearingError{number(json.at("mean")), number(json.at("std")), number(json.at("bias"))};
}

std::optional<ImageCounts> image_counts(const Json& json) {
  if (json.at("images").is_null()) return std::nullopt;
  return ImageCounts{json.at("images").get<int>(), json.at("images_with_bearing").get<int>(),
                     json.at("wrong_targets").get<int>()};
}

std::optional<PoseFigures> pose_figures(const Json& json) {
  if (json.is_null()) return std::nullopt;
  PoseFigures figures;
  json.at("images").get_to(figures.images);
  json.at("with_pose").get_to(figures.with_pose);
  json.at("poses_over_10_deg").get_to(figures.poses_over_10_deg);
  figures.keypoint_error_px = number(json.at("keypoint_error_px"));
  figures.keypoint_chi_square = number(json.at("keypoint_chi_square"));
  const Json& lit = json.at("lit_navigation_error_m");
  figures.lit_navigation_error_m = {number(lit.at("mean")), number(lit.at("std"))};
  figures.attitude_nees = optional_number(json.at("attitude_nees"));
  json.at("attitude_restarts").get_to(figures.attitude_restarts);
  json.at("restarts").get_to(figures.restarts);
  return figures;
}

Summary summary_from(const Json& json) {
  Summary s;
  json.at("mission").get_to(s.mission);
  json.at("seed").get_to(s.seed);
  json.at("complete").get_to(s.complete);
  s.incomplete_reason = text(json.at("incomplete_reason"));
  json.at("flight_computer").get_to(s.flight_computer);
  json.at("flight_software").get_to(s.flight_software);
  s.camera = text(json.at("camera"));
  s.gnss = text(json.at("gnss"));
  s.navigation = text(json.at("navigation"));
  s.simulated_s = number(json.at("simulated_s"));
  s.wall_s = number(json.at("wall_s"));
  s.speed_factor = number(json.at("speed_factor"));
  s.navigation_error_m = mean_and_deviation(json.at("navigation_error_m"));
  s.navigation_velocity_error_mps = mean_and_deviation(json.at("navigation_velocity_error_mps"));
  s.attitude_error_deg = mean_and_deviation(json.at("attitude_error_deg"));
  s.first_fix_s = optional_number(json.at("first_fix_s"));
  s.static_floor_m = optional_number(json.at("static_floor_m"));
  s.navigation_nees = optional_number(json.at("navigation_nees"));
  s.bearing_error_arcsec = bearing_error(json.at("bearing_error_arcsec"));
  s.star_attitude_error_arcsec = mean_and_deviation(json.at("star_attitude_error_arcsec"));
  s.images = image_counts(json);
  s.pose = pose_figures(json.at("pose"));
  s.dv_mps = number(json.at("dv_mps"));
  json.at("maneuvers").get_to(s.maneuvers);
  json.at("commands_sha256").get_to(s.commands_sha256);
  json.at("telemetry_sha256").get_to(s.telemetry_sha256);

  const Json& step = json.at("flight_step");
  step.at("count").get_to(s.flight_step.count);
  step.at("unit").get_to(s.flight_step.unit);
  step.at("max").get_to(s.flight_step.max);
  s.flight_step.mean = number(step.at("mean"));
  step.at("stack_bytes_max").get_to(s.flight_step.stack_bytes_max);

  const Json& link = json.at("link");
  link.at("bytes").get_to(s.link.bytes);
  link.at("frames_resent").get_to(s.link.frames_resent);
  link.at("frames_rejected").get_to(s.link.frames_rejected);
  link.at("frames_duplicated").get_to(s.link.frames_duplicated);
  link.at("strangers_ignored").get_to(s.link.strangers_ignored);
  link.at("baud").get_to(s.link.baud);
  s.link.step_share_max = number(link.at("step_share_max"));
  s.link.step_share_mean = number(link.at("step_share_mean"));

  const Json& deadlines = json.at("deadlines");
  deadlines.at("compute_overruns").get_to(s.deadlines.compute_overruns);
  deadlines.at("wakeups_late").get_to(s.deadlines.wakeups_late);
  deadlines.at("link_late").get_to(s.deadlines.link_late);
  deadlines.at("simulation_late").get_to(s.deadlines.simulation_late);

  const Json& share = json.at("wall_share");
  s.wall_share.truth_s = number(share.at("truth_s"));
  s.wall_share.flight_s = number(share.at("flight_s"));
  s.wall_share.link_s = number(share.at("link_s"));
  s.wall_share.other_s = number(share.at("other_s"));
  s.wall_share.render_s = number(share.at("render_s"));
  s.wall_share.detector_s = number(share.at("detector_s"));
  s.wall_share.packing_s = number(share.at("packing_s"));
  if (json.contains("provenance")) s.provenance = provenance_from(json.at("provenance"));
  return s;
}

}  // namespace

std::string summary_json(const Summary& s, const std::vector<WaypointRow>& waypoints) {
  Json rows = Json::array();
  for (const WaypointRow& row : waypoints) rows.push_back(json_of(row));
  const Json json = {
      {"mission", s.mission},
      {"seed", s.seed},
      {"complete", s.complete},
      {"incomplete_reason", text_or_null(s.incomplete_reason)},
      {"flight_computer", s.flight_computer},
      {"flight_software", s.flight_software},
      {"camera", text_or_null(s.camera)},
      {"gnss", text_or_null(s.gnss)},
      {"navigation", text_or_null(s.navigation)},
      {"simulated_s", s.simulated_s},
      {"wall_s", s.wall_s},
      {"speed_factor", s.speed_factor},
      {"waypoints", rows},
      {"navigation_error_m", json_of(s.navigation_error_m)},
      {"navigation_velocity_error_mps", json_of(s.navigation_velocity_error_mps)},
      {"attitude_error_deg", json_of(s.attitude_error_deg)},
      {"first_fix_s", json_of(s.first_fix_s)},
      {"static_floor_m", json_of(s.static_floor_m)},
      {"navigation_nees", json_of(s.navigation_nees)},
      {"bearing_error_arcsec", json_of(s.bearing_error_arcsec)},
      {"star_attitude_error_arcsec", json_of(s.star_attitude_error_arcsec)},
      {"images", count_or_null(s.images, &ImageCounts::images)},
      {"images_with_bearing", count_or_null(s.images, &ImageCounts::with_bearing)},
      {"wrong_targets", count_or_null(s.images, &ImageCounts::wrong_targets)},
      {"pose", json_of(s.pose)},
      {"dv_mps", s.dv_mps},
      {"maneuvers", s.maneuvers},
      {"commands_sha256", s.commands_sha256},
      {"telemetry_sha256", s.telemetry_sha256},
      {"flight_step",
       {{"count", s.flight_step.count},
        {"unit", s.flight_step.unit},
        {"max", s.flight_step.max},
        {"mean", s.flight_step.mean},
        {"stack_bytes_max", s.flight_step.stack_bytes_max}}},
      {"link",
       {{"bytes", s.link.bytes},
        {"frames_resent", s.link.frames_resent},
        {"frames_rejected", s.link.frames_rejected},
        {"frames_duplicated", s.link.frames_duplicated},
        {"strangers_ignored", s.link.strangers_ignored},
        {"baud", s.link.baud},
        {"step_share_max", s.link.step_share_max},
        {"step_share_mean", s.link.step_share_mean}}},
      {"deadlines",
       {{"compute_overruns", s.deadlines.compute_overruns},
        {"wakeups_late", s.deadlines.wakeups_late},
        {"link_late", s.deadlines.link_late},
        {"simulation_late", s.deadlines.simulation_late}}},
      {"wall_share",
       {{"truth_s", s.wall_share.truth_s},
        {"flight_s", s.wall_share.flight_s},
        {"link_s", s.wall_share.link_s},
        {"other_s", s.wall_share.other_s},
        {"render_s", s.wall_share.render_s},
        {"detector_s", s.wall_share.detector_s},
        {"packing_s", s.wall_share.packing_s}}},
      {"provenance", json_of(s.provenance)},
  };
  // Text that is not UTF-8 (a library's own name for itself) is written with replacement characters, never refused.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Summary read_summary(const std::filesystem::path& file) {
  const std::string content = read_text_file(file);
  try {
    return summary_from(Json::parse(content));
  } catch (const Json::exception& error) {
    throw std::runtime_error(file.string() + ": not a run's summary: " + error.what());
  }
}

bool is_summary(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return false;
  const Json json = Json::parse(read_text_file(file), nullptr, false);
  return json.is_object() && json.contains("mission") && json.contains("complete") && json.contains("commands_sha256");
}

}  // namespace vbar::report
