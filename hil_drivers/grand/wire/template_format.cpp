#include "hil_drivers/grand/wire/template_format.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "hil_drivers/grand/wire/calendar.h"
#include "hil_drivers/grand/wire/skydel.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::grand::wire {

namespace {

constexpr std::int64_t kSecondsPerWeek = 604800;
constexpr std::size_t kMaxVehicles = 99;
constexpr std::size_t kMaxFields = 256;

struct SampleValue {
  std::string_view name;
  fsw::Vector3 TrajectorySample::*vector;
  int component;
};

#define VBAR_COMPONENTS(prefix, member)                                                       \
  {prefix "_x", &TrajectorySample::member, 0}, {prefix "_y", &TrajectorySample::member, 1}, { \
    prefix "_z", &TrajectorySample::member, 2                                                 \
  }

constexpr std::array<SampleValue, 21> kSampleValues = {{
    VBAR_COMPONENTS("position_ecef", position_ecef_m),
    VBAR_COMPONENTS("velocity_ecef", velocity_ecef_mps),
    VBAR_COMPONENTS("acceleration_ecef", acceleration_ecef_mps2),
    VBAR_COMPONENTS("jerk_ecef", jerk_ecef_mps3),
    {"yaw", &TrajectorySample::yaw_pitch_roll, 0},
    {"pitch", &TrajectorySample::yaw_pitch_roll, 1},
    {"roll", &TrajectorySample::yaw_pitch_roll, 2},
    VBAR_COMPONENTS("angular_rate", angular_rate),
    VBAR_COMPONENTS("angular_acceleration", angular_acceleration),
}};

#undef VBAR_COMPONENTS

/// Calls `use` with a zero of the C++ type of `type`.
auto with_type(FieldType type, auto use) {
  switch (type) {
    case FieldType::kU8:
      return use(std::uint8_t{});
    case FieldType::kI8:
      return use(std::int8_t{});
    case FieldType::kU16:
      return use(std::uint16_t{});
    case FieldType::kI16:
      return use(std::int16_t{});
    case FieldType::kU32:
      return use(std::uint32_t{});
    case FieldType::kI32:
      return use(std::int32_t{});
    case FieldType::kU64:
      return use(std::uint64_t{});
    case FieldType::kI64:
      return use(std::int64_t{});
    case FieldType::kF32:
      return use(float{});
    case FieldType::kF64:
      break;
  }
  return use(double{});
}

/// Returns true if `value`, rounded for an integer type, is a value of the type.
template <class Number>
bool fits(double value) {
  if constexpr (std::is_floating_point_v<Number>) {
    return std::isfinite(value) && std::abs(value) <= static_cast<double>(std::numeric_limits<Number>::max());
  } else {
    // The limit above the largest integer is a power of two and therefore exact.
    const double above = std::ldexp(1.0, std::numeric_limits<Number>::digits);
    const double rounded = std::round(value);
    return rounded < above && rounded >= (std::is_signed_v<Number> ? -above : 0.0);
  }
}

std::string label_of(std::size_t index, const TemplateField& field) {
  return fmt::format("field {} ({})", index + 1, field.value.empty() ? "constant" : field.value);
}

void put_field(ByteWriter& writer, FieldType type, double value, const std::string& label) {
  with_type(type, [&](auto zero) {
    using Number = decltype(zero);
    if (!fits<Number>(value))
      throw WireError(fmt::format("template datagram: {}: {} does not fit into its type", label, value));
    if constexpr (std::is_floating_point_v<Number>)
      writer.put(static_cast<Number>(value));
    else
      writer.put(static_cast<Number>(std::round(value)));
  });
}

double get_field(ByteReader& reader, FieldType type, const std::string& label) {
  return with_type(type, [&](auto zero) {
    const auto value = static_cast<double>(reader.get<decltype(zero)>(label));
    if (!std::isfinite(value)) reader.fail(label, "is not finite");
    return value;
  });
}

NamedValues values_of(std::size_t vehicle, const TrajectorySample& sample) {
  NamedValues values;
  values["vehicle"] = static_cast<double>(vehicle + 1);
  values["time_s"] = fsw::seconds(sample.time);
  values["time_ms"] = static_cast<double>(sample.time.ns) / 1e6;
  for (const SampleValue& value : kSampleValues)
    values[std::string(value.name)] = (sample.*value.vector)[value.component];
  return values;
}

TemplateCodec::Received received_of(const NamedValues& values) {
  TemplateCodec::Received received;
  const auto find = [&](std::string_view name) {
    const auto found = values.find(name);
    return found == values.end() ? std::optional<double>() : std::optional<double>(found->second);
  };
  if (const auto vehicle = find("vehicle")) {
    if (std::round(*vehicle) != *vehicle || *vehicle < 1.0 || *vehicle > static_cast<double>(kMaxVehicles))
      throw WireError(fmt::format("template datagram: vehicle {} is not from 1 to {}", *vehicle, kMaxVehicles));
    received.vehicle = static_cast<std::size_t>(*vehicle) - 1;
  }
  const auto time_ms = find("time_ms");
  const double time_s = time_ms ? *time_ms / 1e3 : find("time_s").value_or(0.0);
  constexpr double kMaxTime_s = 1e7;
  if (!(time_s >= 0.0 && time_s <= kMaxTime_s))
    throw WireError(fmt::format("template datagram: time {} s is not from 0 to {} s", time_s, kMaxTime_s));
  received.sample.time = fsw::nearest_duration(time_s);
  for (const SampleValue& value : kSampleValues)
    (received.sample.*value.vector)[value.component] = find(value.name).value_or(0.0);
  check_sample(received.sample, "template datagram");
  return received;
}

std::vector<TextPattern> patterns_of(const std::vector<std::string>& lines) {
  std::vector<TextPattern> patterns;
  for (const std::string& line : lines) patterns.emplace_back(line, control_values());
  return patterns;
}

void check_field(std::size_t index, const TemplateField& field) {
  const auto& known = template_values();
  if (!field.value.empty() && std::find(known.begin(), known.end(), field.value) == known.end())
    throw WireError(
        fmt::format("template {}: unknown value; known are {}", label_of(index, field), fmt::join(known, ", ")));
  if (!std::isfinite(field.scale) || field.scale == 0.0 || !std::isfinite(field.constant))
    throw WireError(
        fmt::format("template {}: scale and constant must be finite and the scale not 0", label_of(index, field)));
  if (field.value.empty()) {
    Bytes scratch;
    ByteWriter writer(scratch);
    put_field(writer, field.type, field.constant, label_of(index, field));
  }
}

void check_names(const std::vector<std::string>& names, VehicleBy vehicle_by) {
  const auto has = [&](std::string_view name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  if (!has("time_s") && !has("time_ms")) throw WireError("template: the datagram has no time_s or time_ms");
  for (const std::string_view name : {"position_ecef_x", "position_ecef_y", "position_ecef_z"})
    if (!has(name)) throw WireError(fmt::format("template: the datagram has no {}", name));
  if (vehicle_by == VehicleBy::kField && !has("vehicle"))
    throw WireError("template: the datagram has no vehicle, and vehicle = \"port\" is not set");
}

std::string describe(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

const std::vector<std::string_view>& template_values() {
  static const std::vector<std::string_view> kNames = [] {
    std::vector<std::string_view> names = {"vehicle", "time_s", "time_ms"};
    for (const SampleValue& value : kSampleValues) names.push_back(value.name);
    return names;
  }();
  return kNames;
}

const std::vector<std::string_view>& control_values() {
  static const std::vector<std::string_view> kNames = {"vehicle", "vehicles", "year",     "month",     "day",   "hour",
                                                       "minute",  "second",   "gps_week", "gps_tow_s", "time_s"};
  return kNames;
}

NamedValues control_values_of(fsw::GpsTime start, std::size_t vehicles) {
  const Calendar date = calendar_of(start);
  const std::int64_t s = start.ns / fsw::kNanosecondsPerSecond;
  return {{"vehicles", static_cast<double>(vehicles)},
          {"year", date.year},
          {"month", date.month},
          {"day", date.day},
          {"hour", date.hour},
          {"minute", date.minute},
          {"second", date.second},
          {"gps_week", static_cast<double>(s / kSecondsPerWeek)},
          {"gps_tow_s", static_cast<double>(s % kSecondsPerWeek)}};
}

std::optional<fsw::GpsTime> start_time_of(const NamedValues& values) {
  const auto whole = [&](std::string_view name, double high) {
    const auto found = values.find(name);
    if (found == values.end()) throw WireError(fmt::format("start time: {} is missing", name));
    if (!(found->second >= 0.0 && found->second <= high) || std::round(found->second) != found->second)
      throw WireError(fmt::format("start time: {} = {} is not a whole number from 0 to {}", name, found->second, high));
    return static_cast<unsigned>(found->second);
  };
  if (values.contains("year"))
    return time_of({static_cast<int>(whole("year", 9999)), whole("month", 12), whole("day", 31), whole("hour", 23),
                    whole("minute", 59), whole("second", 59)});
  if (!values.contains("gps_week")) return std::nullopt;
  constexpr double kLastWeek = 11479;  // in the year 2199
  return fsw::GpsTime{} + fsw::duration_of_seconds(std::int64_t{whole("gps_week", kLastWeek)} * kSecondsPerWeek +
                                                   std::int64_t{whole("gps_tow_s", 604799.0)});
}

TemplateCodec::TemplateCodec(TemplateFormat format)
    : format_(std::move(format)),
      prepare_(patterns_of(format_.prepare_lines)),
      start_(patterns_of(format_.start_lines)),
      stop_(patterns_of(format_.stop_lines)),
      progress_answer_(format_.progress_answer, control_values()) {
  if (!format_.text.empty()) {
    if (!format_.fields.empty()) throw WireError("template: a datagram has either fields or a text, not both");
    text_.emplace(format_.text, template_values());
    check_names(text_->names(), format_.vehicle_by);
  } else {
    if (format_.fields.empty() || format_.fields.size() > kMaxFields)
      throw WireError(
          fmt::format("template: {} fields; accepted are 1 to {}, or a text", format_.fields.size(), kMaxFields));
    std::vector<std::string> names;
    for (std::size_t k = 0; k < format_.fields.size(); ++k) {
      check_field(k, format_.fields[k]);
      names.push_back(format_.fields[k].value);
    }
    check_names(names, format_.vehicle_by);
  }
  if (format_.start_lines.empty()) throw WireError("template: no start_lines");
  if (format_.progress_line.empty()) return;
  progress_.emplace(format_.progress_line, control_values());
  const auto names = progress_answer_.names();
  if (std::find(names.begin(), names.end(), "time_s") == names.end())
    throw WireError("template: progress_answer has no {time_s}, only " + describe(names));
}

Bytes TemplateCodec::encode(std::size_t vehicle, const TrajectorySample& sample) const {
  check_sample(sample, "template datagram");
  const NamedValues values = values_of(vehicle, sample);
  Bytes bytes;
  ByteWriter writer(bytes, format_.byte_order);
  if (text_) {
    writer.put(std::string_view(text_->format(values)));
    return bytes;
  }
  for (std::size_t k = 0; k < format_.fields.size(); ++k) {
    const TemplateField& field = format_.fields[k];
    const double value = field.value.empty() ? field.constant : values.find(field.value)->second * field.scale;
    put_field(writer, field.type, value, label_of(k, field));
  }
  return bytes;
}

NamedValues TemplateCodec::decode_fields(std::span<const std::uint8_t> datagram) const {
  ByteReader reader(datagram, "template datagram", format_.byte_order);
  NamedValues values;
  for (std::size_t k = 0; k < format_.fields.size(); ++k) {
    const TemplateField& field = format_.fields[k];
    const std::string label = label_of(k, field);
    const double value = get_field(reader, field.type, label);
    if (!field.value.empty()) {
      values[field.value] = value / field.scale;
      continue;
    }
    const bool is_expected = with_type(field.type, [&](auto zero) {
      using Number = decltype(zero);
      if constexpr (std::is_floating_point_v<Number>)
        return value == static_cast<double>(static_cast<Number>(field.constant));
      else
        return value == std::round(field.constant);
    });
    if (!is_expected) reader.fail(label, fmt::format("is {}, not {}", value, field.constant));
  }
  reader.finish();
  return values;
}

TemplateCodec::Received TemplateCodec::decode(std::span<const std::uint8_t> datagram) const {
  if (!text_) return received_of(decode_fields(datagram));
  return received_of(text_->parse({reinterpret_cast<const char*>(datagram.data()), datagram.size()}));
}

namespace {

TemplateField read_field(const mission::TableReader& section) {
  constexpr double kLargest = 1e300;
  TemplateField field;
  const bool has_constant = section.has("constant");
  if (has_constant == section.has("value"))
    section.refuse("", has_constant ? "both value and constant" : "neither value nor constant",
                   "one of them in each field");
  if (has_constant) {
    field.constant = section.number("constant", mission::from_to(-kLargest, kLargest));
  } else {
    field.value = section.choice("value", template_values(), "");
    field.scale = section.number("scale", mission::from_to(-kLargest, kLargest), 1.0);
  }
  field.type = section.choice("type", kFieldTypes);
  section.finish();
  return field;
}

}  // namespace

TemplateFormat read_template_format(const mission::TableReader& section) {
  TemplateFormat format;
  for (const mission::TableReader& field : section.tables("fields")) format.fields.push_back(read_field(field));
  format.byte_order = section.choice("byte_order", kByteOrders, std::optional(format.byte_order));
  format.text = section.text("text", format.text);
  format.vehicle_by = section.choice("vehicle", kVehicleBys, std::optional(format.vehicle_by));
  format.prepare_lines = section.texts("prepare_lines");
  format.start_lines = section.texts("start_lines");
  format.stop_lines = section.texts("stop_lines");
  format.accepted_answer = section.text("accepted_answer", format.accepted_answer);
  format.progress_line = section.text("progress_line", format.progress_line);
  format.progress_answer = section.text("progress_answer", format.progress_answer);
  try {
    static_cast<void>(TemplateCodec(format));
  } catch (const WireError& error) {
    section.refuse("", error.what(), "a description that both writes and reads datagrams and lines");
  }
  return format;
}

}  // namespace vbar::grand::wire
