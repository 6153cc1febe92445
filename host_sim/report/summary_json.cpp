#include "host_sim/report/summary_json.h"

#include <cmath>
#include <concepts>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "host_sim/files/output_file.h"
#include "host_sim/report/json_file.h"

namespace vbar::report {
namespace {

/// Version of the keys below. A file of a newer version is rejected: its meaning is unknown here.
constexpr int kSchema = 2;

template <class Some, class Type>
concept Is = std::is_same_v<std::remove_const_t<Some>, Type>;

// The members of each object, once for both directions.

void members(Is<MeanAndDeviation> auto& s, auto& visit) {
  visit("mean", s.mean);
  visit("std", s.std);
}

void members(Is<BearingError> auto& s, auto& visit) {
  visit("mean", s.mean);
  visit("std", s.std);
  visit("bias", s.bias);
}

void members(Is<Sample> auto& s, auto& visit) {
  visit("time_h", s.time_h);
  visit("navigation_error_m", s.navigation_error_m);
  visit("navigation_error_r_m", s.navigation_error_r_m);
  visit("navigation_error_t_m", s.navigation_error_t_m);
  visit("navigation_error_n_m", s.navigation_error_n_m);
  visit("navigation_velocity_error_mps", s.navigation_velocity_error_mps);
  visit("sigma_m", s.sigma_m);
  visit("sigma_r_m", s.sigma_r_m);
  visit("sigma_t_m", s.sigma_t_m);
  visit("sigma_n_m", s.sigma_n_m);
  visit("sigma_velocity_mps", s.sigma_velocity_mps);
  visit("nees", s.nees);
  visit("nees_dimension", s.nees_dimension);
  visit("nis", s.nis);
  visit("nis_dimension", s.nis_dimension);
}

void members(Is<SourceFigures> auto& s, auto& visit) {
  visit("name", s.name);
  visit("kind", s.kind);
  visit("epochs", s.epochs);
  visit("failures", s.failures);
  visit("last_failure", s.last_failure);
  visit("late", s.late);
  visit("latest_s", s.latest_s);
  visit("packets_rejected", s.packets_rejected);
}

void members(Is<Summary::FlightStep> auto& s, auto& visit) {
  visit("count", s.count);
  visit("unit", s.unit);
  visit("max", s.max);
  visit("mean", s.mean);
  visit("stack_bytes_max", s.stack_bytes_max);
}

void members(Is<FlightOutput> auto& s, auto& visit) {
  visit("steps", s.steps);
  visit("steps_failed", s.steps_failed);
  visit("last_status", s.last_status);
  visit("steps_silent", s.steps_silent);
  visit("packets", s.packets);
  visit("packets_invalid", s.packets_invalid);
  visit("packets_dropped", s.packets_dropped);
  visit("inputs_refused", s.inputs_refused);
}

void members(Is<RunFacts::Link> auto& s, auto& visit) {
  visit("bytes", s.bytes);
  visit("frames_resent", s.frames_resent);
  visit("frames_rejected", s.frames_rejected);
  visit("frames_duplicated", s.frames_duplicated);
  visit("strangers_ignored", s.strangers_ignored);
  visit("baud", s.baud);
  visit("step_share_max", s.step_share_max);
  visit("step_share_mean", s.step_share_mean);
  visit("wired_bytes", s.wired_bytes);
  visit("wired_bytes_dropped", s.wired_bytes_dropped);
  visit("wired_bytes_missing", s.wired_bytes_missing);
  visit("wired_timeouts", s.wired_timeouts);
}

void members(Is<RunFacts::Deadlines> auto& s, auto& visit) {
  visit("compute_overruns", s.compute_overruns);
  visit("wakeups_late", s.wakeups_late);
  visit("link_late", s.link_late);
  visit("simulation_late", s.simulation_late);
}

void members(Is<RunFacts::WallShare> auto& s, auto& visit) {
  visit("truth_s", s.truth_s);
  visit("flight_s", s.flight_s);
  visit("link_s", s.link_s);
  visit("other_s", s.other_s);
  visit("render_s", s.render_s);
  visit("detector_s", s.detector_s);
  visit("packing_s", s.packing_s);
}

void members(Is<telemetry_health> auto& s, auto& visit) {
  visit_fields(s, [&](const Field& field, auto& value) { visit(field.name, value, field.codes); });
}

void members(Is<Thrust> auto& s, auto& visit) {
  visit("max_thrust_n", s.max_thrust_n);
  visit("mass_kg", s.mass_kg);
  visit("burns", s.burns);
  visit("burns_too_long", s.burns_too_long);
  visit("longest_burn_s", s.longest_burn_s);
  visit("longest_burn_at_h", s.longest_burn_at_h);
}

void members(Is<FileDigest> auto& s, auto& visit) {
  visit("file", s.file);
  visit("bytes", s.bytes);
  visit("sha256", s.sha256);
}

void members(Is<Provenance> auto& s, auto& visit) {
  visit("vbar_version", s.vbar_version);
  visit("commit", s.commit);
  visit("compiler", s.compiler);
  visit("build_type", s.build_type);
  visit("program_sha256", s.program_sha256);
  visit("host", s.host);
  visit("started_utc", s.started_utc);
  visit("epoch_utc", s.epoch_utc);
  visit("mission_sha256", s.mission_sha256);
  visit("overrides", s.overrides);
  visit("flight_software", s.flight_software);
  visit("testbed", s.testbed);
  visit("data", s.data);
  visit("packet_log", s.packet_log);
}

void members(Is<WaypointRow> auto& s, auto& visit) {
  visit("index", s.index);
  visit("time_s", s.time_s);
  visit("navigation_error_m", s.navigation_error_m);
  visit("navigation_velocity_error_mps", s.navigation_velocity_error_mps);
  visit("control_error_m", s.control_error_m);
  visit("leg_dv_mps", s.leg_dv_mps);
  visit("cumulative_dv_mps", s.cumulative_dv_mps);
  visit("leg_maneuvers", s.leg_maneuvers);
}

void members(Is<Summary> auto& s, auto& visit) {
  visit("mission", s.mission);
  visit("seed", s.seed);
  visit("complete", s.complete);
  visit("incomplete_reason", s.incomplete_reason);
  visit("verdict", s.verdict);
  visit("verdict_reason", s.verdict_reason);
  visit("missed_waypoints", s.missed_waypoints);
  visit("never_navigated", s.never_navigated);
  visit("flight_computer", s.flight_computer);
  visit("flight_software", s.flight_software);
  visit("camera", s.camera);
  visit("gnss", s.gnss);
  visit("navigation", s.navigation);
  visit("target", s.target);
  visit("simulated_s", s.simulated_s);
  visit("wall_s", s.wall_s);
  visit("speed_factor", s.speed_factor);
  visit("navigation_error_m", s.navigation_error_m);
  visit("navigation_velocity_error_mps", s.navigation_velocity_error_mps);
  visit("attitude_error_deg", s.attitude_error_deg);
  visit("first_fix_s", s.first_fix_s);
  visit("static_floor_m", s.static_floor_m);
  visit("navigation_nees", s.navigation_nees);
  visit("navigation_nees_dimension", s.navigation_nees_dimension);
  visit("navigation_nis", s.navigation_nis);
  visit("navigation_nis_dimension", s.navigation_nis_dimension);
  visit("samples", s.samples);
  visit("bearing_error_arcsec", s.bearing_error_arcsec);
  visit("star_attitude_error_arcsec", s.star_attitude_error_arcsec);
  visit("sensor_figures", s.sensor_figures);
  visit("min_distance_m", s.min_distance_m);
  visit("min_distance_at_h", s.min_distance_at_h);
  visit("dv_mps", s.dv_mps);
  visit("maneuvers", s.maneuvers);
  visit("thrust", s.thrust);
  visit("commands_sha256", s.commands_sha256);
  visit("telemetry_sha256", s.telemetry_sha256);
  visit("health", s.health);
  visit("flight_output", s.flight_output);
  visit("flight_step", s.flight_step);
  visit("link", s.link);
  visit("deadlines", s.deadlines);
  visit("sources", s.sources);
  visit("wall_share", s.wall_share);
  visit("data_notes", s.data_notes);
  visit("provenance", s.provenance);
}

/// Members into a JSON object. JSON has no NaN: a number that is not finite is null, as nlohmann writes it, and so is a
/// text that is empty.
struct Writer {
  Json json = Json::object();

  void operator()(const char* key, const auto& value) { json[key] = json_of(value); }
  void operator()(const char* key, const auto& value, const Codes& codes) {
    if (!codes.are_bits) return (*this)(key, value);
    json[key] = Json::array();
    for (int k = 0; k < codes.count; ++k)
      if ((value & codes.codes[k].value) != 0) json[key].push_back(codes.codes[k].word);
  }
  template <class Value>
  static Json json_of(const Value& value) {
    if constexpr (std::is_same_v<Value, std::string>) {
      return value.empty() ? Json(nullptr) : Json(value);
    } else if constexpr (requires { typename Value::mapped_type; }) {
      Json all = Json::object();
      for (const auto& [key, one] : value) all[key] = json_of(one);
      return all;
    } else if constexpr (requires { value.valueless_by_exception(); }) {
      return std::visit([](const auto& one) { return json_of(one); }, value);
    } else if constexpr (requires { value.begin(); }) {
      Json all = Json::array();
      for (const auto& one : value) all.push_back(json_of(one));
      return all;
    } else if constexpr (requires { value.has_value(); }) {
      // Means of nothing keep their members, so that a script finds them whatever was flown.
      using Inner = typename Value::value_type;
      if (value || !(std::is_same_v<Inner, MeanAndDeviation> || std::is_same_v<Inner, BearingError>))
        return value ? json_of(*value) : Json(nullptr);
      Json nulls = json_of(Inner{});
      for (auto& item : nulls) item = nullptr;
      return nulls;
    } else if constexpr (std::is_class_v<Value>) {
      Writer writer;
      members(value, writer);
      return writer.json;
    } else {
      return Json(value);
    }
  }
};

/// Members out of a JSON object; one that is missing keeps its default.
struct Reader {
  const Json& json;

  void operator()(const char* key, auto& value) {
    if (!json.contains(key)) return;
    try {
      read(json.at(key), value);
    } catch (const Json::exception& error) {
      throw std::runtime_error(std::string("key \"") + key + "\": " + error.what());
    }
  }
  void operator()(const char* key, auto& value, const Codes& codes) {
    if (!codes.are_bits) return (*this)(key, value);
    if (!json.contains(key)) return;
    for (const Json& word : json.at(key))
      for (int k = 0; k < codes.count; ++k)
        if (word == codes.codes[k].word) value |= codes.codes[k].value;
  }
  template <class Value>
  static void read(const Json& from, Value& value) {
    if constexpr (requires { value.has_value(); }) {
      const bool is_empty = from.is_null() || (from.contains("mean") && from.at("mean").is_null());
      if (!is_empty) read(from, value.emplace());
    } else if constexpr (std::is_same_v<Value, double>) {
      value = from.is_null() ? std::numeric_limits<double>::quiet_NaN() : from.get<double>();
    } else if constexpr (std::is_same_v<Value, std::string>) {
      value = from.is_null() ? std::string() : from.get<std::string>();
    } else if constexpr (requires { value.valueless_by_exception(); }) {
      if (from.is_string()) {
        read(from, value.template emplace<std::string>());
      } else {
        read(from, value.template emplace<double>());
      }
    } else if constexpr (requires { typename Value::mapped_type; }) {
      for (const auto& [key, one] : from.items()) read(one, value[key]);
    } else if constexpr (requires { value.push_back(value.front()); }) {
      for (const Json& one : from) read(one, value.emplace_back());
    } else if constexpr (std::is_class_v<Value>) {
      if (!from.is_object()) throw std::runtime_error("an object is expected");
      Reader reader{from};
      members(value, reader);
    } else {
      from.get_to(value);
    }
  }
};

}  // namespace

std::string summary_json(const Summary& summary, const std::vector<WaypointRow>& waypoints) {
  Json json = {{"schema", kSchema}};
  json.update(Writer::json_of(summary));
  json["testbeds"] = Json::array();
  for (const auto& [name, figures] : summary.testbeds) {
    json["testbeds"].push_back(name);
    json[name] = Writer::json_of(figures);
  }
  json["waypoints"] = Json::array();
  for (const WaypointRow& row : waypoints) json["waypoints"].push_back(Writer::json_of(row));
  // Text that is not UTF-8 (a library's own name for itself) is written with replacement characters, never refused.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Summary read_summary(const std::filesystem::path& file) {
  const auto fail = [&](const char* what) {
    throw std::runtime_error(file.string() + ": not a run's summary: " + what);
  };
  Summary summary;
  try {
    const Json json = read_json_file(file);
    const int schema = json.value("schema", 0);
    if (schema > kSchema) {
      throw std::runtime_error(file.string() + ": made by a newer version of this program (schema " +
                               std::to_string(schema) + "; this one reads up to " + std::to_string(kSchema) + ")");
    }
    Reader::read(json, summary);
    for (const Json& name : json.value("testbeds", Json::array()))
      Reader::read(json.at(name.get<std::string>()), summary.testbeds[name.get<std::string>()]);
  } catch (const Json::exception& error) {
    fail(error.what());
  } catch (const std::runtime_error& error) {
    if (std::string_view(error.what()).starts_with(file.string())) throw;
    fail(error.what());
  }
  return summary;
}

bool is_summary(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return false;
  const Json json = Json::parse(files::read_text_file(file), nullptr, false);
  return json.is_object() && json.contains("mission") && json.contains("complete") && json.contains("commands_sha256");
}

}  // namespace vbar::report
