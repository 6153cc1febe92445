#include "hil_drivers/grand/wire/simgen.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "hil_drivers/grand/wire/calendar.h"
#include "hil_drivers/grand/wire/skydel.h"
#include "hil_drivers/grand/wire/text_pattern.h"

namespace vbar::grand::wire {
namespace {

using fsw::Vector3;

constexpr std::size_t kMotNumbers = 24;
constexpr std::int64_t kNsPerMs = 1'000'000;
constexpr std::size_t kMaxReply = 65536;
constexpr unsigned kMaxVehicles = 99;

constexpr std::array<std::string_view, 12> kMonths = {"JAN", "FEB", "MAR", "APR", "MAY", "JUN",
                                                      "JUL", "AUG", "SEP", "OCT", "NOV", "DEC"};

enum class UdpType : std::uint32_t { kMot = 0 };
enum class UdpAction : std::uint32_t { kNow = 0, kAtTime = 1 };

/// The 24 numbers in their order, without the angular jerk.
std::array<Vector3*, 7> vectors_of(TrajectorySample& sample) {
  return {&sample.position_ecef_m, &sample.velocity_ecef_mps, &sample.acceleration_ecef_mps2, &sample.jerk_ecef_mps3,
          &sample.yaw_pitch_roll,  &sample.angular_rate,      &sample.angular_acceleration};
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

std::optional<double> number(std::string_view text) {
  std::size_t length = 0;
  const double value = leading_number(text, length);
  if (length == 0 || length != text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<unsigned> whole_number(std::string_view text, unsigned limit) {
  unsigned value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || result.ec != std::errc{} || result.ptr != text.data() + text.size() || value > limit)
    return std::nullopt;
  return value;
}

/// "[d ]hh:mm:ss[.sss]" or seconds.
std::optional<fsw::Duration> span_of(std::string_view text) {
  unsigned days = 0;
  if (const std::size_t blank = text.find(' '); blank != std::string_view::npos) {
    const auto parsed = whole_number(text.substr(0, blank), 99);
    if (!parsed) return std::nullopt;
    days = *parsed;
    text = trimmed(text.substr(blank));
  }
  const auto parts = split(text, ':');
  if (parts.size() != 1 && parts.size() != 3) return std::nullopt;
  const auto s = number(parts.back());
  if (!s || *s < 0.0 || *s > (parts.size() == 1 ? 8.64e6 : 60.0)) return std::nullopt;
  fsw::Duration span = fsw::nearest_duration(*s) + fsw::duration_of_seconds(std::int64_t{86400} * days);
  if (parts.size() == 1) return span;
  const auto hours = whole_number(parts[0], 999);
  const auto minutes = whole_number(parts[1], 59);
  if (!hours || !minutes) return std::nullopt;
  return span + fsw::duration_of_seconds(std::int64_t{3600} * *hours + std::int64_t{60} * *minutes);
}

std::string clock_text(std::int64_t whole_seconds) {
  return fmt::format("{:02}:{:02}:{:02}", whole_seconds / 3600, whole_seconds / 60 % 60, whole_seconds % 60);
}

std::int64_t whole_milliseconds(fsw::Duration time) {
  if (time.ns % kNsPerMs != 0)
    throw WireError(fmt::format("SimGEN motion: time {} ns is not a whole number of milliseconds", time.ns));
  return time.ns / kNsPerMs;
}

void check_motion(const SimgenMotion& motion) {
  check_sample(motion.sample, "SimGEN motion");
  if (motion.vehicle < 1 || motion.vehicle > kMaxVehicles)
    throw WireError(fmt::format("SimGEN motion: vehicle {} is not from 1 to {}", motion.vehicle, kMaxVehicles));
}

/// The text between <tag> and </tag>; empty without it.
std::optional<std::string_view> element(std::string_view message, std::string_view tag) {
  const std::string open = fmt::format("<{}>", tag);
  const std::string close = fmt::format("</{}>", tag);
  const std::size_t begin = message.find(open);
  if (begin == std::string_view::npos) return std::nullopt;
  const std::size_t end = message.find(close, begin);
  if (end == std::string_view::npos) return std::nullopt;
  return trimmed(message.substr(begin + open.size(), end - begin - open.size()));
}

}  // namespace

std::string_view text_of(SimgenStatus status) {
  constexpr std::array<std::string_view, 8> kTexts = {
      "No scenario specified", "Loading", "Ready", "Arming", "Armed", "Running", "Paused", "Ended"};
  const auto index = static_cast<std::size_t>(status);
  return index < kTexts.size() ? kTexts[index] : "unknown status";
}

Bytes encode_mot(const SimgenMotion& motion) {
  check_motion(motion);
  SimgenMotion copy = motion;
  Bytes bytes;
  bytes.reserve(kSimgenMotBytes);
  ByteWriter writer(bytes);
  writer.put(static_cast<std::uint32_t>(UdpType::kMot));
  writer.put(static_cast<std::uint32_t>(motion.is_timed ? UdpAction::kAtTime : UdpAction::kNow));
  writer.put(static_cast<std::uint32_t>(whole_milliseconds(motion.sample.time)));
  writer.put(static_cast<std::uint32_t>(motion.vehicle));
  for (const Vector3* vector : vectors_of(copy.sample)) writer.put(*vector);
  writer.put(Vector3(Vector3::Zero()));  // angular jerk
  writer.put(std::int32_t{0});           // latency
  writer.put(std::uint32_t{0});          // padding
  return bytes;
}

SimgenMotion decode_mot(std::span<const std::uint8_t> datagram) {
  if (datagram.size() != kSimgenMotBytes && datagram.size() != kSimgenMotPackedBytes)
    throw WireError(fmt::format("SimGEN datagram: {} bytes; accepted are {} and {}", datagram.size(), kSimgenMotBytes,
                                kSimgenMotPackedBytes));
  ByteReader reader(datagram, "SimGEN datagram");
  const auto type = reader.get<std::uint32_t>("type");
  if (type != static_cast<std::uint32_t>(UdpType::kMot)) reader.fail("type", fmt::format("{} is not 0 (MOT)", type));
  const auto action = reader.get<std::uint32_t>("action");
  if (action > static_cast<std::uint32_t>(UdpAction::kAtTime))
    reader.fail("action", fmt::format("{} is not 0 or 1", action));
  SimgenMotion motion;
  motion.is_timed = action == static_cast<std::uint32_t>(UdpAction::kAtTime);
  motion.sample.time = {static_cast<std::int64_t>(reader.get<std::uint32_t>("time of validity")) * kNsPerMs};
  motion.vehicle = reader.get<std::uint32_t>("vehicle");
  for (Vector3* vector : vectors_of(motion.sample)) *vector = reader.vector("motion");
  static_cast<void>(reader.vector("angular jerk"));
  static_cast<void>(reader.get<std::int32_t>("latency"));
  check_motion(motion);
  return motion;
}

std::string mot_line(const SimgenMotion& motion) {
  check_motion(motion);
  const std::int64_t ms = whole_milliseconds(motion.sample.time);
  const std::int64_t s = ms / 1000;
  std::string line =
      motion.is_timed ? fmt::format("{} {}.{:03}", s / 86400, clock_text(s % 86400), ms % 1000) : std::string("-");
  line += fmt::format(",MOT,v{}_m1", motion.vehicle);
  SimgenMotion copy = motion;
  for (const Vector3* vector : vectors_of(copy.sample))
    for (const double component : *vector) line += fmt::format(",{}", component);
  line += ",0,0,0";
  return line;
}

std::string start_time_line(fsw::GpsTime start, fsw::Duration duration) {
  const Calendar date = calendar_of(start);
  return fmt::format("START_TIME,{:02}-{}-{} {:02}:{:02}:{:02},{}", date.day, kMonths.at(date.month - 1), date.year,
                     date.hour, date.minute, date.second, clock_text(duration.ns / fsw::kNanosecondsPerSecond));
}

SimgenCommand parse_simgen_command(std::string_view line) {
  constexpr std::size_t kMaxLine = 4096;
  if (line.size() > kMaxLine)
    throw WireError(fmt::format("SimGEN line: {} characters; at most {} are accepted", line.size(), kMaxLine));
  const auto parts = split(trimmed(line), ',');
  SimgenCommand command;
  std::size_t name = 0;
  const std::string_view first = trimmed(parts[0]);
  const bool has_time = first == "-" || (!first.empty() && std::isdigit(static_cast<unsigned char>(first.front())));
  if (has_time) {
    if (first != "-") {
      command.time = span_of(first);
      if (!command.time)
        throw WireError(fmt::format("SimGEN line \"{}\": \"{}\" is not a time", printable(line), printable(first)));
    }
    name = 1;
  }
  if (name >= parts.size() || trimmed(parts[name]).empty())
    throw WireError(fmt::format("SimGEN line \"{}\": the command is missing", printable(line)));
  command.name = upper(trimmed(parts[name]));
  for (std::size_t k = name + 1; k < parts.size(); ++k) command.arguments.emplace_back(trimmed(parts[k]));
  return command;
}

SimgenMotion motion_of(const SimgenCommand& command) {
  const auto fail = [](const std::string& problem) { throw WireError("SimGEN MOT: " + problem); };
  if (command.arguments.size() != 1 + kMotNumbers)
    fail(fmt::format("{} arguments; the vehicle and {} numbers are expected", command.arguments.size(), kMotNumbers));
  SimgenMotion motion;
  motion.is_timed = command.time.has_value();
  motion.sample.time = command.time.value_or(fsw::Duration{});
  const std::string vehicle = upper(command.arguments[0]);
  const std::size_t end = vehicle.find("_M1");
  const auto index = vehicle.starts_with('V') && end + 3 == vehicle.size()
                         ? whole_number(std::string_view(vehicle).substr(1, end - 1), kMaxVehicles)
                         : std::nullopt;
  if (!index) fail(fmt::format("vehicle \"{}\" is not v1_m1, v2_m1, ...", printable(command.arguments[0])));
  motion.vehicle = *index;
  std::array<double, kMotNumbers> numbers{};
  for (std::size_t k = 0; k < kMotNumbers; ++k) {
    const auto value = number(command.arguments[1 + k]);
    if (!value)
      fail(fmt::format("number {} is \"{}\", not a finite number", k + 1, printable(command.arguments[1 + k])));
    numbers[k] = *value;
  }
  std::size_t k = 0;
  for (Vector3* vector : vectors_of(motion.sample))
    for (double& component : *vector) component = numbers[k++];
  check_motion(motion);
  return motion;
}

SimgenStart start_of(const SimgenCommand& command) {
  const auto fail = [&]() -> SimgenStart {
    throw WireError(fmt::format("SimGEN START_TIME: \"{}\" is not \"dd-MMM-yyyy hh:mm:ss,hh:mm:ss\"",
                                printable(fmt::format("{}", fmt::join(command.arguments, ",")))));
  };
  if (command.arguments.size() < 2) return fail();
  const std::string_view text = command.arguments[0];
  const std::size_t blank = text.find(' ');
  if (blank == std::string_view::npos) return fail();
  const auto date = split(text.substr(0, blank), '-');
  const auto clock = span_of(trimmed(text.substr(blank)));
  const auto duration = span_of(command.arguments[1]);
  if (date.size() != 3 || !clock || !duration) return fail();
  const auto day = whole_number(date[0], 31);
  const auto year = whole_number(date[2], 2199);
  const auto* month = std::find(kMonths.begin(), kMonths.end(), upper(date[1]));
  if (!day || !year || month == kMonths.end() || clock->ns >= 86400 * fsw::kNanosecondsPerSecond) return fail();
  const fsw::GpsTime midnight =
      time_of({static_cast<int>(*year), static_cast<unsigned>(month - kMonths.begin()) + 1, *day, 0, 0, 0});
  return {midnight + *clock, *duration};
}

std::string encode_reply(const SimgenReply& reply) {
  // The reply is XML, where these characters have a meaning.
  const auto text = [](std::string_view raw) {
    std::string clean(raw);
    for (char& c : clean)
      if (c == '<' || c == '>' || c == '&') c = '?';
    return clean;
  };
  std::string message = fmt::format("<msg><status>{}</status>", reply.status);
  if (!reply.data.empty()) message += fmt::format("<data>{}</data>", text(reply.data));
  if (!reply.error.empty()) message += fmt::format("<error>{}</error>", text(reply.error));
  return message + "</msg>";
}

SimgenReply parse_reply(std::string_view message) {
  const auto content = element(message, "msg");
  const auto status = content ? element(*content, "status") : std::nullopt;
  const auto value = status ? whole_number(*status, 99) : std::nullopt;
  if (!value) throw WireError(fmt::format("SimGEN reply \"{}\": no <status> with a number", printable(message)));
  SimgenReply reply;
  reply.status = static_cast<int>(*value);
  if (const auto data = element(*content, "data")) reply.data = *data;
  for (const std::string_view tag : {"error", "fatal"})
    if (const auto error = element(*content, tag)) reply.error = error->empty() ? std::string(tag) : printable(*error);
  return reply;
}

std::size_t reply_length(std::string_view stream) {
  constexpr std::string_view kEnd = "</msg>";
  const std::size_t end = stream.find(kEnd);
  if (end != std::string_view::npos) return end + kEnd.size();
  if (stream.size() > kMaxReply)
    throw WireError(fmt::format("SimGEN reply \"{}\": no {} in {} characters", printable(stream), kEnd, stream.size()));
  return 0;
}

fsw::Duration time_of_data(std::string_view data) {
  const auto span = span_of(trimmed(data));
  if (!span) throw WireError(fmt::format("SimGEN reply: \"{}\" is not a time into run", printable(data)));
  return *span;
}

}  // namespace vbar::grand::wire
