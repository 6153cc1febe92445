#include "host_sim/campaign/case_records.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "fsw/packets/crc.h"
#include "host_sim/campaign/campaign_file.h"
#include "host_sim/campaign/plan.h"
#include "host_sim/files/data_stream.h"
#include "host_sim/files/output_file.h"
#include "host_sim/simulation/limit_check.h"

namespace vbar::campaign {

namespace {

constexpr std::string_view kChecksum = ",\"crc32\":\"";
constexpr std::size_t kDigits = 8;

std::string checksum_of(std::string_view text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  return fmt::format("{:08x}", fsw::packets::crc32_ieee(bytes));
}

std::optional<Json> object_of(std::string_view line) {
  const std::size_t end = kChecksum.size() + kDigits + 2;  // the quote and the brace
  if (line.size() < end || line.substr(line.size() - end, kChecksum.size()) != kChecksum) return std::nullopt;
  if (!line.ends_with("\"}")) return std::nullopt;
  const std::string body = std::string(line.substr(0, line.size() - end)) + "}";
  if (line.substr(line.size() - kDigits - 2, kDigits) != checksum_of(body)) return std::nullopt;
  Json object = Json::parse(body, nullptr, false);
  if (!object.is_object()) return std::nullopt;
  return object;
}

}  // namespace

std::string line_of(const Json& object) {
  std::string text = object.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::string checksum = checksum_of(text);
  text.pop_back();
  return fmt::format("{}{}{}\"}}", text, kChecksum, checksum);
}

RecordFile::RecordFile(std::filesystem::path file) : file_(std::move(file)) {
  errno = 0;
  descriptor_ = io::FileDescriptor(::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644));
  if (descriptor_.get() < 0 || ::flock(descriptor_.get(), LOCK_EX | LOCK_NB) != 0) throw files::write_error(file_);
}

void RecordFile::append(const Json& object, Sync sync) {
  const std::string line = line_of(object) + "\n";
  std::string_view left = line;
  while (!left.empty()) {
    errno = 0;
    const ssize_t written = ::write(descriptor_.get(), left.data(), left.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw files::write_error(file_);
    left.remove_prefix(static_cast<std::size_t>(written));
  }
  if (sync == Sync::kYes && ::fdatasync(descriptor_.get()) != 0) throw files::write_error(file_);
}

bool is_being_written(const std::filesystem::path& file) {
  const io::FileDescriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  return descriptor.get() >= 0 && ::flock(descriptor.get(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

ReadLines read_lines_of(const std::filesystem::path& file) {
  const std::string text = files::read_text_file(file);
  ReadLines read;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos) break;  // the writer was killed in it
    if (auto object = object_of(rest.substr(0, end)))
      read.lines.push_back(std::move(*object));
    else
      ++read.damaged;
    rest.remove_prefix(end + 1);
  }
  return read;
}

namespace {

/// Numbers of this execution rather than of the flight: by the wall clock, or of the program and the computer.
constexpr std::array<std::string_view, 8> kLeftOut{"schema",     "seed",       "wall_s", "speed_factor",
                                                   "wall_share", "provenance", "link",   "deadlines"};
constexpr std::array<std::string_view, 2> kLeftOutOfSources{"late", "latest_s"};
constexpr std::array<std::string_view, 2> kLabels{"index", "time_h"};

bool contains(const auto& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// "10" of a waypoint, "39.5h" of a sample, the name of a source; empty of what nothing identifies.
std::string label_of(const Json& element) {
  if (!element.is_object()) return {};
  if (element.contains("index")) return element["index"].dump();
  if (element.contains("name") && element["name"].is_string()) return element["name"].get<std::string>();
  if (!element.contains("time_h")) return {};
  std::string hours = text_of(element["time_h"].get<double>());
  if (hours.ends_with(".0")) hours.resize(hours.size() - 2);
  return hours + "h";
}

bool is_mean_and_deviation(const Json& json) {
  return json.is_object() && json.contains("mean") && json.contains("std") && json.size() <= 3;
}

/// navigation_error_m, mean: navigation_error_mean_m.
std::string with_unit_last(const std::string& key, const std::string& statistic) {
  const std::size_t unit = key.rfind('_');
  return unit == std::string::npos ? key + "_" + statistic : key.substr(0, unit) + "_" + statistic + key.substr(unit);
}

void add(const std::string& key, const Json& value, Numbers& numbers);

void add_members(const std::string& prefix, const Json& object, Numbers& numbers) {
  for (const auto& [name, value] : object.items()) {
    if (prefix.empty() && contains(kLeftOut, name)) continue;
    if (!prefix.empty() && contains(kLabels, name)) continue;
    if (prefix.starts_with("sources.") && contains(kLeftOutOfSources, name)) continue;
    add(prefix + name, value, numbers);
  }
}

void add(const std::string& key, const Json& value, Numbers& numbers) {
  if (is_mean_and_deviation(value)) {
    for (const auto& [statistic, number] : value.items()) add(with_unit_last(key, statistic), number, numbers);
  } else if (value.is_object()) {
    add_members(key + ".", value, numbers);
  } else if (value.is_array()) {
    for (const Json& element : value)
      if (const std::string label = label_of(element); !label.empty())
        add_members(key + "." + label + ".", element, numbers);
  } else if (value.is_number()) {
    numbers.emplace_back(key, value.get<double>());
  }
}

}  // namespace

Numbers numbers_of(const Json& summary) {
  Numbers numbers;
  add_members("", summary, numbers);
  return numbers;
}

std::string waypoints_sha256(const Json& summary) {
  return files::sha256_of(summary.contains("waypoints") ? summary["waypoints"].dump() : std::string());
}

std::optional<double> find_number(const Numbers& numbers, const std::string& key) {
  const auto found = std::ranges::find(numbers, key, &Numbers::value_type::first);
  return found == numbers.end() ? std::nullopt : std::optional(found->second);
}

namespace {

void add(const Json& line, std::map<std::string, std::size_t>& open, AllAttempts& all) {
  const auto number = line.at("case").get<std::size_t>();
  const auto attempt = line.at("attempt").get<std::string>();
  Attempts& attempts = all.of_case[number];
  if (!line.contains("end")) {
    ++attempts.begun;
    open[attempt] = number;
    return;
  }
  open.erase(attempt);
  attempts.last_end = line.at("end").get<std::string>();
  if (line.at("kill").get<bool>()) ++attempts.killed;
}

}  // namespace

AllAttempts read_attempts(const std::filesystem::path& attempt_files) {
  AllAttempts all;
  for (const std::filesystem::path& file : record_files(attempt_files)) {
    const bool lives = is_being_written(file);
    if (lives) all.living_workers.push_back(file.stem().string());
    std::map<std::string, std::size_t> open;
    for (const Json& line : read_lines_of(file).lines) {
      try {
        add(line, open, all);
      } catch (const Json::exception&) {
        continue;  // counts nothing; the results decide
      }
    }
    if (!lives) continue;
    for (const auto& [attempt, number] : open) all.of_case[number].flies = true;
  }
  return all;
}

Json begin_line(std::size_t number, const std::string& attempt, const std::string& host, std::int64_t process) {
  return {{"case", number}, {"attempt", attempt}, {"host", host}, {"process", process}};
}

Json end_line(std::size_t number, const std::string& attempt, const std::string& end, bool is_kill) {
  return {{"case", number}, {"attempt", attempt}, {"end", end}, {"kill", is_kill}};
}

namespace {

constexpr std::array<std::pair<State, std::string_view>, 8> kStates{{{State::kComplete, "complete"},
                                                                     {State::kFailed, "failed"},
                                                                     {State::kOverTime, "over_time"},
                                                                     {State::kLost, "lost"},
                                                                     {State::kVoid, "void"},
                                                                     {State::kNotBegun, "not_begun"},
                                                                     {State::kFlying, "flying"},
                                                                     {State::kKilled, "killed"}}};

State state_of(const std::string& name) {
  for (const auto& [state, word] : kStates)
    if (word == name) return state;
  throw std::runtime_error("an unknown state: " + name);
}

bool has_flown(const Result& result) {
  return result.state == State::kComplete || result.state == State::kVoid;
}

void add(Result&& result, AllResults& all) {
  const auto [place, is_new] = all.of_case.try_emplace(result.number, result);
  if (is_new) return;
  Result& before = place->second;
  if (has_flown(before) && has_flown(result) && !before.has_same_outputs(result))
    all.conflicts.push_back(fmt::format("case {}: two flights with different outputs, on {} ({}) and on {} ({})",
                                        result.number, before.host, before.processor, result.host, result.processor));
  if (!has_flown(before)) before = std::move(result);
}

using NameLines = std::map<std::size_t, std::vector<std::string>>;  // lines of one file, by their numbers

Json json_of(const Result& result, std::size_t name_line) {
  Json numbers = Json::array();
  for (const auto& [name, value] : result.numbers) numbers.push_back(value);
  return {{"case", result.number},
          {"attempt", result.attempt},
          {"state", name_of(result.state)},
          {"reason", result.reason},
          {"verdict", result.verdict},
          {"host", result.host},
          {"processor", result.processor},
          {"wall_s", result.wall_s},
          {"cpu_s", result.cpu_s},
          {"commands_sha256", result.commands_sha256},
          {"telemetry_sha256", result.telemetry_sha256},
          {"waypoints_sha256", result.waypoints_sha256},
          {"case_sha256", result.case_sha256},
          {"folder", result.folder},
          {"name_line", name_line},
          {"numbers", std::move(numbers)}};
}

/// Throws an exception for an object that is not a result, or whose line of names is missing.
Result result_of(const Json& json, const NameLines& name_lines) {
  Result result;
  json.at("case").get_to(result.number);
  json.at("attempt").get_to(result.attempt);
  result.state = state_of(json.at("state").get<std::string>());
  json.at("reason").get_to(result.reason);
  result.verdict = json.value("verdict", "");  // an older version of this program wrote none
  json.at("host").get_to(result.host);
  json.at("processor").get_to(result.processor);
  json.at("wall_s").get_to(result.wall_s);
  json.at("cpu_s").get_to(result.cpu_s);
  json.at("commands_sha256").get_to(result.commands_sha256);
  json.at("telemetry_sha256").get_to(result.telemetry_sha256);
  json.at("waypoints_sha256").get_to(result.waypoints_sha256);
  json.at("case_sha256").get_to(result.case_sha256);
  json.at("folder").get_to(result.folder);
  if (!result.folder.empty() && result.folder != Folder("").runs() / name_of_case(result.number))
    throw std::runtime_error("a folder other than that of the case");
  const std::vector<std::string>& names = name_lines.at(json.at("name_line").get<std::size_t>());
  const auto numbers = json.at("numbers").get<std::vector<double>>();
  if (numbers.size() != names.size()) throw std::runtime_error("numbers and names differ in number");
  for (std::size_t k = 0; k < names.size(); ++k) result.numbers.emplace_back(names[k], numbers[k]);
  return result;
}

}  // namespace

std::string_view name_of(State state) {
  return std::ranges::find(kStates, state, &std::pair<State, std::string_view>::first)->second;
}

void ResultFile::append(const Result& result) {
  std::vector<std::string> names;
  for (const auto& [name, value] : result.numbers) names.push_back(name);
  if (name_lines_ == 0 || names != names_) {
    file_.append({{"name_line", ++name_lines_}, {"names", names}}, RecordFile::Sync::kNo);
    names_ = std::move(names);
  }
  file_.append(json_of(result, name_lines_), RecordFile::Sync::kYes);
}

std::vector<std::string> failed_limits(const Plan& plan, const Result& result) {
  std::vector<std::string> keys;
  for (const PassCriterion& criterion : plan.passes)
    if (!check::meets(criterion, find_number(result.numbers, criterion.key)) &&
        std::ranges::find(keys, criterion.key) == keys.end())
      keys.push_back(criterion.key);
  return keys;
}

bool has_passed(const Plan& plan, const Result& result) {
  return result.state == State::kComplete && result.reason.empty() && failed_limits(plan, result).empty();
}

AllResults read_results(const std::filesystem::path& result_files) {
  AllResults all;
  for (const std::filesystem::path& file : record_files(result_files)) {
    const ReadLines read = read_lines_of(file);
    all.damaged_lines += read.damaged;
    NameLines name_lines;
    for (const Json& line : read.lines) {
      try {
        if (line.contains("names"))
          line.at("names").get_to(name_lines[line.at("name_line").get<std::size_t>()]);
        else
          add(result_of(line, name_lines), all);
      } catch (const std::exception&) {
        ++all.damaged_lines;
      }
    }
  }
  return all;
}

}  // namespace vbar::campaign
