#include "host_sim/sensors/range_finder/range_finder_kind.h"

#include <cmath>

#include <fmt/format.h>

#include "fsw/math/math.h"
#include "fsw/packets/messages.h"
#include "host_sim/mission/read_attitude.h"
#include "host_sim/sensors/sensor_kind.h"
#include "host_sim/twins/recorded_log.h"

namespace vbar::sensors {
namespace {

using mission::above_to;
using mission::from_to;
using mission::TableReader;

std::shared_ptr<const mission::SensorSettings> read(const TableReader& section, const mission::SensorContext& context) {
  auto sensor = std::make_shared<RangeFinderSensor>();
  RangeFinderSettings& settings = sensor->range_finder;
  mission::read_source(section, "digital", context, *sensor);
  sensor->target = mission::read_other_spacecraft(section, context.spacecraft, context.spacecraft_names);
  settings.period = section.span("period_s", 1.0, from_to(0.01, 1e4), 1.0);
  settings.range_min_m = section.number("range_min_m", from_to(0.0, 1e6), 0.5);
  settings.range_max_m = section.number("range_max_m", above_to(0.0, 1e6), 1000.0);
  settings.bias_sigma_m = section.number("bias_sigma_m", from_to(0.0, 1e3), 0.02);
  settings.noise_sigma_m = section.number("noise_sigma_m", from_to(0.0, 1e3), 0.01);
  settings.half_angle_rad =
      0.5 * section.number("field_of_view_deg", above_to(0.0, 180.0), 20.0) * fsw::math::kPi / 180.0;
  const auto axis = section.three_numbers("boresight_body", from_to(-1.0, 1.0), std::array{0.0, 0.0, 1.0});
  sensor->is_used_by_navigation = section.flag("used_by_navigation", false);
  if (sensor->is_used_by_navigation) sensor->navigation = vbar::navigation_configuration::kUseRangeFinder;
  section.finish();
  if (sensor->is_used_by_navigation && !(settings.noise_sigma_m > 0.0)) {
    section.refuse_value("noise_sigma_m", "a number above 0: navigation weights its ranges by it");
  }
  const fsw::Vector3 boresight(axis[0], axis[1], axis[2]);
  if (!(boresight.norm() > 1e-6)) section.refuse_value("boresight_body", "an axis that is not zero");
  settings.boresight_body = boresight.normalized();
  if (!(settings.range_min_m < settings.range_max_m)) section.refuse_value("range_max_m", "a range above range_min_m");
  return sensor;
}

void check(const TableReader& section, const mission::Sensor& /*sensor*/, const mission::Spacecraft& spacecraft,
           const mission::Mission& /*mission*/) {
  if (!spacecraft.attitude)
    section.refuse("", "no attitude of " + spacecraft.name,
                   "a spacecraft with an attitude: the boresight points somewhere");
}

/// Adds the telecommand with the errors of the range finder, if navigation uses its ranges.
void add_telecommands(const mission::Sensor& sensor, const TelecommandContext& /*context*/,
                      Telecommands& telecommands) {
  const auto& own = settings_of<RangeFinderSensor>(sensor);
  if (!own.is_used_by_navigation) return;
  vbar::range_configuration configuration{};
  configuration.noise_sigma_m = own.range_finder.noise_sigma_m;
  configuration.bias_sigma_m = own.range_finder.bias_sigma_m;
  telecommands.add(configuration);
}

/// Checks a measurement that a testbed provides: it must be within the limits of the range, but for errors of six
/// sigmas.
std::string fault_of_range(const fsw::packets::PacketView& packet, const RangeFinderSettings& settings) {
  const auto measurement = fsw::packets::decode<vbar::range_measurement>(packet);
  if (!measurement.ok()) return {};  // found before
  const double margin_m = 6.0 * std::hypot(settings.bias_sigma_m, settings.noise_sigma_m);
  const double low_m = settings.range_min_m - margin_m, high_m = settings.range_max_m + margin_m;
  const double range_m = measurement.value().range_m;
  if (range_m >= low_m && range_m <= high_m) return {};
  return fmt::format("a range of {:g} m; accepted: {:g} to {:g} m, the limits of the sensor and six sigmas", range_m,
                     low_m, high_m);
}

void add_sources(const mission::Sensor& sensor, const MakeContext& context, std::vector<twins::NamedSource>& sources) {
  const auto& own = settings_of<RangeFinderSensor>(sensor);
  const std::string name = source_name(context.servicer, sensor);
  if (own.source == "recorded") {
    const twins::RecordedLog::Selection selection{context.servicer.number, {fsw::packets::Apid::kRangeMeasurement}};
    sources.push_back({name, own.source, std::make_unique<twins::RecordedLog>(own.log, selection)});
    return;
  }
  if (auto packets = only_packets_of_testbed(sensor, kRangeFinder, context, fsw::packets::Apid::kRangeMeasurement,
                                             [settings = own.range_finder](const fsw::packets::PacketView& packet) {
                                               return fault_of_range(packet, settings);
                                             })) {
    sources.push_back({name, own.source, std::move(packets)});
    return;
  }
  const RangeFinder::Place place{context.servicer.name, own.target, context.servicer.number,
                                 unit_of(sensor, context.servicer), context.mission.start_time()};
  sources.push_back(
      {name, own.source,
       std::make_unique<RangeFinder>(own.range_finder, place, engine::RandomStream(context.mission.seed, name))});
}

std::vector<report::TableKind> tables() {
  return {report::table_of_extension<RangeRow>("range_finder.csv")};
}

std::vector<report::Section> sections(const report::RunRecord& record) {
  return {range_section(record)};
}

}  // namespace

const SensorKind kRangeFinder{{"range_finder", "", read, nullptr, check},
                              {fsw::packets::Apid::kRangeMeasurement},
                              add_telecommands,
                              add_sources,
                              nullptr,
                              evaluate_ranges,
                              true,
                              {tables, summarise_ranges, sections}};

}  // namespace vbar::sensors
