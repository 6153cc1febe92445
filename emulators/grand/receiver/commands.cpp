#include "emulators/grand/receiver/commands.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "emulators/grand/receiver/logs.h"
#include "fsw/gnss/oem_fields.h"

namespace vbar::grand::bench {
namespace {

struct Word {
  std::string_view name;
  double value;
};

enum class FieldType : std::uint8_t { kPort, kMessage, kChoice, kWhole, kFloat, kDouble };

struct Field {
  FieldType type;
  double low = 0.0;
  double high = 0.0;
  std::span<const Word> words;
  std::optional<double> default_value = std::nullopt;  ///< none: the field is required
};

struct CommandKind {
  CommandId id;
  std::string_view name;
  std::vector<Field> fields;
};

constexpr std::array<Word, 10> kPortWords{{{"NO_PORTS", 0},
                                           {"COM1_ALL", 1},
                                           {"COM2_ALL", 2},
                                           {"COM3_ALL", 3},
                                           {"THISPORT_ALL", 6},
                                           {"ALL_PORTS", 8},
                                           {"ALL", 8},
                                           {"COM1", 32},
                                           {"COM2", 64},
                                           {"COM3", 96}}};
constexpr Word kThisPortWord{"THISPORT", 192};
constexpr std::array<Word, 6> kTriggerWords{
    {{"ONNEW", 0}, {"ONCHANGED", 1}, {"ONTIME", 2}, {"ONNEXT", 3}, {"ONCE", 4}, {"ONMARK", 5}}};
constexpr std::array<Word, 2> kHoldWords{{{"NOHOLD", 0}, {"HOLD", 1}}};
constexpr std::array<Word, 2> kFlagWords{{{"FALSE", 0}, {"TRUE", 1}}};
constexpr std::array<Word, 2> kOffOnWords{{{"OFF", 0}, {"ON", 1}}};
constexpr std::array<Word, 3> kParityWords{{{"N", 0}, {"E", 1}, {"O", 2}}};
constexpr std::array<Word, 3> kHandshakeWords{{{"N", 0}, {"XON", 1}, {"CTS", 2}}};
constexpr std::array<Word, 2> kEnableWords{{{"DISABLE", 0}, {"ENABLE", 1}}};
constexpr std::array<Word, 3> kPpsWords{{{"DISABLE", 0}, {"ENABLE", 1}, {"ENABLE_FINETIME", 2}}};
constexpr std::array<Word, 2> kPolarityWords{{{"NEGATIVE", 0}, {"POSITIVE", 1}}};
constexpr std::array<Word, 4> kFresetWords{{{"STANDARD", 0}, {"COMMAND", 1}, {"GPSALMANAC", 2}, {"GPSEPHEM", 3}}};

Field port(PortId default_port) {
  return {FieldType::kPort, 0, 0, kPortWords, static_cast<double>(default_port)};
}
Field message() {
  return {FieldType::kMessage, 0, 0, {}};
}
Field choice(std::span<const Word> words, std::optional<double> default_value = std::nullopt) {
  return {FieldType::kChoice, 0, 0, words, default_value};
}
Field whole(double low, double high, std::optional<double> default_value = std::nullopt) {
  return {FieldType::kWhole, low, high, {}, default_value};
}
Field real(double low, double high, std::optional<double> default_value = std::nullopt) {
  return {FieldType::kDouble, low, high, {}, default_value};
}
Field single(double low, double high) {
  return {FieldType::kFloat, low, high, {}, std::nullopt};
}

const std::vector<CommandKind>& command_kinds() {
  static const std::vector<CommandKind> kinds{
      {CommandId::kLog,
       "LOG",
       {port(PortId::kThisPort), message(), choice(kTriggerWords, kDefaultTrigger), real(0, 86400, 0),
        real(0, 86400, 0), choice(kHoldWords, 0)}},
      {CommandId::kCom,
       "COM",
       {port(PortId::kThisPort), whole(0, 1e6), choice(kParityWords, 0), whole(7, 8, 8), whole(1, 2, 1),
        choice(kHandshakeWords, 0), choice(kOffOnWords, 0), choice(kOffOnWords, 1)}},
      {CommandId::kClockAdjust, "CLOCKADJUST", {choice(kEnableWords)}},
      {CommandId::kReset, "RESET", {whole(0, 3600, 0)}},
      {CommandId::kSaveConfig, "SAVECONFIG", {}},
      {CommandId::kFreset, "FRESET", {choice(kFresetWords, 0)}},
      {CommandId::kUnlog, "UNLOG", {port(PortId::kThisPort), message()}},
      {CommandId::kUnlogAll, "UNLOGALL", {port(PortId::kAllPorts), choice(kFlagWords, 0)}},
      {CommandId::kElevationCutoff, "ECUTOFF", {single(-90, 90)}},
      {CommandId::kSetApproxTime, "SETAPPROXTIME", {whole(0, 9999), real(0, 604801)}},
      {CommandId::kCodeSmoothing, "CSMOOTH", {whole(2, 2000), whole(2, 2000, 100)}},
      {CommandId::kSetApproxPos, "SETAPPROXPOS", {real(-90, 90), real(-360, 360), real(-1000, 2e7)}},
      {CommandId::kPpsControl,
       "PPSCONTROL",
       {choice(kPpsWords), choice(kPolarityWords, 0), real(0.05, 100, 1), whole(0, 1'000'000'000, 1000)}},
      {CommandId::kSerialConfig,
       "SERIALCONFIG",
       {port(PortId::kThisPort), whole(0, 1e6), choice(kParityWords, 0), whole(7, 8, 8), whole(1, 2, 1),
        choice(kHandshakeWords, 0), choice(kOffOnWords, 1)}},
  };
  return kinds;
}

bool same_word(std::string_view a, std::string_view b) {
  const auto capital = [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; };
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [&](char x, char y) { return capital(x) == capital(y); });
}

std::optional<double> value_of_word(std::span<const Word> words, std::string_view text) {
  for (const Word& word : words)
    if (same_word(word.name, text)) return word.value;
  return std::nullopt;
}

std::optional<double> port_of(std::string_view text) {
  if (same_word(text, kThisPortWord.name)) return kThisPortWord.value;
  return value_of_word(kPortWords, text);
}

std::optional<double> message_of(std::string_view text) {
  const auto with_format = [](const LogKind& kind, LogFormat format) {
    return static_cast<double>(static_cast<std::uint32_t>(kind.id) + 65536U * static_cast<std::uint32_t>(format));
  };
  for (const LogKind& kind : kLogKinds) {
    if (same_word(text, kind.name)) return with_format(kind, LogFormat::kAbbreviated);
    if (text.empty() || !same_word(text.substr(0, text.size() - 1), kind.name)) continue;
    if (same_word(text.substr(text.size() - 1), "B")) return with_format(kind, LogFormat::kBinary);
    if (same_word(text.substr(text.size() - 1), "A")) return with_format(kind, LogFormat::kAscii);
  }
  return std::nullopt;
}

std::optional<double> number_of(std::string_view text) {
  double value = 0.0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

bool in_range(const Field& field, double value) {
  if (field.type == FieldType::kWhole && value != std::floor(value)) return false;
  return value >= field.low && value <= field.high;
}

std::optional<Response> read_text_field(const Field& field, std::size_t index, std::string_view text, double& value) {
  std::optional<double> found;
  switch (field.type) {
    case FieldType::kPort:
      found = port_of(text);
      if (!found) return unknown_port();
      break;
    case FieldType::kMessage:
      found = message_of(text);
      if (!found) return no_such_log();
      break;
    case FieldType::kChoice:
      found = value_of_word(field.words, text);
      if (!found) return invalid_field(index);
      break;
    case FieldType::kWhole:
    case FieldType::kFloat:
    case FieldType::kDouble:
      found = number_of(text);
      if (!found) return invalid_field(index);
      if (!in_range(field, *found)) return out_of_range(index);
      break;
  }
  value = *found;
  return std::nullopt;
}

std::size_t binary_size(FieldType type) {
  return type == FieldType::kDouble ? 8 : 4;
}

std::optional<Response> read_binary_field(const Field& field, std::size_t index, std::span<const std::uint8_t> bytes,
                                          double& value) {
  using namespace vbar::fsw::gnss;
  const std::uint32_t raw = read_u32(bytes, 0);
  value = raw;
  switch (field.type) {
    case FieldType::kPort:
      return std::nullopt;  // resolved by the command
    case FieldType::kMessage: {
      if (find_log_kind(static_cast<std::uint16_t>(raw & 0xFFFFU)) == nullptr) return no_such_log();
      const std::uint32_t format = (raw >> 21U) & 3U;
      if (format > static_cast<std::uint32_t>(LogFormat::kAbbreviated)) return invalid_field(index);
      value = static_cast<double>((raw & 0xFFFFU) + 65536U * format);
      return std::nullopt;
    }
    case FieldType::kChoice:
      if (std::ranges::none_of(field.words, [value](const Word& word) { return word.value == value; }))
        return invalid_field(index);
      return std::nullopt;
    case FieldType::kWhole:
      break;
    case FieldType::kFloat:
      value = read_f32(bytes, 0);
      break;
    case FieldType::kDouble:
      value = read_f64(bytes, 0);
      break;
  }
  if (!in_range(field, value)) return out_of_range(index);
  return std::nullopt;
}

const CommandKind* find_kind(CommandId id) {
  const auto& kinds = command_kinds();
  const auto found = std::ranges::find(kinds, id, &CommandKind::id);
  return found == kinds.end() ? nullptr : &*found;
}

}  // namespace

Response no_such_log() {
  return {2, "ERROR:Requested log does not exist"};
}
Response not_enough_resources() {
  return {3, "ERROR:Not enough resources in system"};
}
Response command_failed() {
  return {5, "ERROR:Command failed on receiver"};
}
Response invalid_message_id() {
  return {6, "ERROR:Invalid Message ID"};
}
Response invalid_field(std::size_t field) {
  return {7, fmt::format("ERROR:Invalid Message. Field = {}", field + 1)};
}
Response invalid_checksum() {
  return {8, "ERROR:Invalid Checksum"};
}
Response missing_field() {
  return {9, "ERROR:Message missing field"};
}
Response out_of_range(std::size_t field) {
  return {11, fmt::format("ERROR:Parameter {} is out of range", field + 1)};
}
Response invalid_trigger(std::size_t field) {
  return {14, fmt::format("ERROR:Trigger {} not valid for this log", field + 1)};
}
Response invalid_rate() {
  return {21, "ERROR:Requested rate is invalid"};
}
Response incorrect_message() {
  return {26, "ERROR:Message is incorrect"};
}
Response unknown_port() {
  return {33, "ERROR:Unknown COM port requested"};
}
Response invalid_baud() {
  return {35, "ERROR:Invalid baud rate"};
}
Response invalid_offset() {
  return {41, "ERROR:Invalid offset"};
}

ReadCommand read_text_command(std::string_view name, const std::vector<std::string_view>& words) {
  const auto& kinds = command_kinds();
  const auto kind = std::ranges::find_if(kinds, [name](const CommandKind& k) { return same_word(k.name, name); });
  if (kind == kinds.end()) return invalid_message_id();
  Command command{kind->id, {}};
  std::size_t next = 0;
  for (std::size_t k = 0; k < kind->fields.size(); ++k) {
    const Field& field = kind->fields[k];
    // A port may be left out.
    const bool omitted =
        next >= words.size() || (field.type == FieldType::kPort && words.size() > 0 && !port_of(words[next]));
    if (omitted) {
      if (!field.default_value) return missing_field();
      command.values[k] = *field.default_value;
      continue;
    }
    if (const auto refusal = read_text_field(field, k, words[next++], command.values[k])) return *refusal;
  }
  if (next < words.size()) return incorrect_message();
  return command;
}

ReadCommand read_binary_command(std::uint16_t id, std::span<const std::uint8_t> body) {
  const CommandKind* const kind = find_kind(static_cast<CommandId>(id));
  if (kind == nullptr) return invalid_message_id();
  Command command{kind->id, {}};
  for (std::size_t k = 0; k < kind->fields.size(); ++k) {
    const Field& field = kind->fields[k];
    const std::size_t size = binary_size(field.type);
    if (body.size() < size) {
      if (!body.empty() || !field.default_value) return missing_field();
      command.values[k] = *field.default_value;
      continue;
    }
    if (const auto refusal = read_binary_field(field, k, body, command.values[k])) return *refusal;
    body = body.subspan(size);
  }
  return command;
}

std::string_view name_of(CommandId id) {
  const CommandKind* const kind = find_kind(id);
  return kind == nullptr ? std::string_view{} : kind->name;
}

}  // namespace vbar::grand::bench
