#include "hil_drivers/zaber/messages.h"

#include <algorithm>
#include <charconv>
#include <vector>

#include <fmt/format.h>

namespace vbar::zaber {
namespace {

constexpr std::size_t kMaxLine = 512;
constexpr std::size_t kChecksumLength = 3;

[[noreturn]] void refuse(std::string_view line, std::string_view problem) {
  throw WireError(fmt::format("the line \"{}\" {}", wire::printable(line), problem));
}

/// What stands between the first character and the checksum, which is checked.
std::string_view body_of(std::string_view line, bool& has_checksum) {
  if (line.size() > kMaxLine) refuse(line, "is longer than 512 characters");
  if (!std::ranges::all_of(line, [](char c) { return c >= 0x20 && c < 0x7f; }))
    refuse(line, "has characters that are not printable");
  std::string_view body = line.substr(1);
  const std::size_t colon = body.rfind(':');
  has_checksum = colon != std::string_view::npos && body.size() - colon == kChecksumLength;
  if (colon != std::string_view::npos && !has_checksum) refuse(line, "has a colon that no two digits follow");
  if (!has_checksum) return body;
  std::string found(body.substr(colon + 1));
  std::ranges::transform(found, found.begin(),
                         [](char c) { return c >= 'a' && c <= 'f' ? static_cast<char>(c - 32) : c; });
  body = body.substr(0, colon);
  if (found != checksum_of(body)) refuse(line, fmt::format("has another checksum than {}", checksum_of(body)));
  return body;
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t begin = text.find_first_not_of(' '); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(' ', end);
  }
  return words;
}

std::optional<int> number_of(std::string_view word, int max) {
  int value = -1;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || value < 0 || value > max) return std::nullopt;
  return value;
}

std::string joined(const std::vector<std::string_view>& words, std::size_t first) {
  std::string text;
  for (std::size_t k = first; k < words.size(); ++k) {
    if (k > first) text += ' ';
    text += words[k];
  }
  return text;
}

std::string with_checksum(std::string line, bool has_checksum) {
  if (has_checksum) line += ":" + checksum_of(std::string_view(line).substr(1));
  return line;
}

void require_text(std::string_view text) {
  const bool is_text =
      std::ranges::all_of(text, [](char c) { return c >= 0x20 && c < 0x7f && c != ':'; }) && text.size() < kMaxLine / 2;
  if (!is_text) throw WireError(fmt::format("\"{}\" cannot stand in a line", wire::printable(text)));
}

bool is_number(std::string_view word) {
  return !word.empty() && std::ranges::all_of(word, [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::string checksum_of(std::string_view characters) {
  unsigned sum = 0;
  for (const char c : characters) sum += static_cast<std::uint8_t>(c);
  return fmt::format("{:02X}", (0U - sum) & 0xffU);
}

std::string encode(const Command& command) {
  require_text(command.text);
  std::string line = fmt::format("/{} {}", command.device, command.axis);
  if (command.id) line += fmt::format(" {}", *command.id);
  if (!command.text.empty()) line += " " + command.text;
  return with_checksum(std::move(line), command.has_checksum);
}

std::string encode(const Message& message) {
  require_text(message.data);
  require_text(message.warning);
  std::string line(1, "@#!"[static_cast<std::size_t>(message.kind)]);
  line += fmt::format("{:02} {}", message.device, message.axis);
  if (message.id) line += fmt::format(" {:02}", *message.id);
  if (message.kind == MessageKind::kReply) line += message.is_rejected ? " RJ" : " OK";
  if (message.kind != MessageKind::kInformation)
    line += fmt::format(" {} {}", message.is_busy ? "BUSY" : "IDLE", message.warning);
  if (!message.data.empty()) line += " " + message.data;
  return with_checksum(std::move(line), message.has_checksum);
}

Command decode_command(std::string_view line) {
  if (line.empty() || line.front() != '/') refuse(line, "does not begin with /");
  Command command;
  const std::vector<std::string_view> words = words_of(body_of(line, command.has_checksum));
  std::size_t next = 0;
  const auto take = [&](int max, const char* name) -> std::optional<int> {
    if (next >= words.size() || !is_number(words[next])) return std::nullopt;
    const auto value = number_of(words[next], max);
    if (!value) refuse(line, fmt::format("has no {} from 0 to {}", name, max));
    ++next;
    return value;
  };
  if (const auto device = take(kMaxDevice, "device")) {
    command.device = *device;
    if (const auto axis = take(kMaxAxis, "axis")) {
      command.axis = *axis;
      command.id = take(99, "message number");
    }
  }
  command.text = joined(words, next);
  return command;
}

Message decode_message(std::string_view line) {
  if (line.empty() || std::string_view("@#!").find(line.front()) == std::string_view::npos)
    refuse(line, "does not begin with @, # or !");
  Message message;
  message.kind = line.front() == '@'   ? MessageKind::kReply
                 : line.front() == '#' ? MessageKind::kInformation
                                       : MessageKind::kAlert;
  const std::vector<std::string_view> words = words_of(body_of(line, message.has_checksum));
  std::size_t next = 0;
  const auto word = [&](const char* name) {
    if (next >= words.size()) refuse(line, fmt::format("ends before its {}", name));
    return words[next++];
  };
  const auto choice = [&](const char* yes, const char* no, const char* name) {
    const std::string_view found = word(name);
    if (found != yes && found != no) refuse(line, fmt::format("has neither {} nor {}", yes, no));
    return found == yes;
  };
  const auto number = [&](int max, const char* name) {
    const auto value = number_of(word(name), max);
    if (!value) refuse(line, fmt::format("has no {} from 0 to {}", name, max));
    return *value;
  };
  message.device = number(kMaxDevice, "device");
  message.axis = number(kMaxAxis, "axis");
  if (message.kind != MessageKind::kInformation && next < words.size() && is_number(words[next]))
    message.id = number(99, "message number");
  if (message.kind == MessageKind::kReply) message.is_rejected = choice("RJ", "OK", "answer");
  if (message.kind != MessageKind::kInformation) {
    message.is_busy = choice("BUSY", "IDLE", "state");
    message.warning = word("warning");
    if (message.warning.size() != 2) refuse(line, "has a warning that is not two characters");
  }
  message.data = joined(words, next);
  if (message.kind == MessageKind::kReply && message.data.empty()) refuse(line, "ends before its data");
  return message;
}

}  // namespace vbar::zaber
