#include "emulators/grand/receiver/console.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "fsw/gnss/oem_fields.h"
#include "host_sim/twins/gnss/oem_encoder.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::grand::bench {
namespace {

using fsw::gnss::read_little_endian;
namespace oem = twins::gnss::oem;

constexpr std::int64_t kSilence_ns = 1'000'000'000;
constexpr std::size_t kMinHeader = 28;
constexpr std::size_t kCrcBytes = 4;

std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = text.find_first_not_of(separators);
    if (begin == std::string_view::npos) return words;
    text.remove_prefix(begin);
    const std::size_t end = std::min(text.find_first_of(separators), text.size());
    words.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
}

std::span<const std::uint8_t> as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string_view text_of(oem::TimeStatus status) {
  switch (status) {
    case oem::TimeStatus::kUnknown:
      return "UNKNOWN";
    case oem::TimeStatus::kApproximate:
      return "APPROXIMATE";
    case oem::TimeStatus::kCoarse:
      return "COARSE";
    case oem::TimeStatus::kCoarseSteering:
      return "COARSESTEERING";
    case oem::TimeStatus::kFreewheeling:
      return "FREEWHEELING";
    case oem::TimeStatus::kFine:
      return "FINE";
    case oem::TimeStatus::kFineSteering:
      return "FINESTEERING";
  }
  return "UNKNOWN";
}

}  // namespace

std::string ascii_message(std::string_view name, int port, const oem::Header& header, std::string_view fields) {
  const bool known = header.status != oem::TimeStatus::kUnknown;
  const auto time = twins::gnss::week_time(twins::gnss::System::kGps, header.time);
  const std::string content = fmt::format(
      "{},COM{},0,90.0,{},{},{:.3f},{:08x},0000,0;{}", name, port + 1, text_of(header.status), known ? time.week : 0,
      known ? static_cast<double>(time.ns_of_week / 1'000'000) * 1e-3 : 0.0, header.status_word(), fields);
  return fmt::format("#{}*{:08x}\r\n", content, oem::crc32(as_bytes(content)));
}

std::string Console::prompt() const {
  return fmt::format("[COM{}]", port_ + 1);
}

void Console::restart() {
  line_.clear();
  line_spoilt_ = after_carriage_return_ = false;
  binary_.clear();
}

void Console::listen(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (now_ns - last_byte_ns_ > kSilence_ns) binary_.clear();
  last_byte_ns_ = now_ns;
  for (const std::uint8_t byte : bytes) take(byte);
}

void Console::take(std::uint8_t byte) {
  constexpr std::uint8_t kSync = 0xAA;
  if (!binary_.empty() || byte == kSync) {
    take_binary(byte);
    return;
  }
  const bool line_end = byte == '\r' || byte == '\n';
  if (line_end && !(byte == '\n' && after_carriage_return_)) end_line();
  after_carriage_return_ = byte == '\r';
  if (line_end) return;
  const bool is_text = (byte >= 0x20 && byte < 0x7F) || byte == '\t';
  if (!is_text || line_.size() >= kMaxLine) {
    line_spoilt_ = true;
    return;
  }
  line_.push_back(static_cast<char>(byte));
}

void Console::end_line() {
  const std::string line = std::exchange(line_, {});
  if (std::exchange(line_spoilt_, false)) {
    ++refused_;  // noise, or a rate that does not match: no answer would be understood
    return;
  }
  const std::size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string::npos) {
    answer_text("\r\n" + prompt());
    return;
  }
  const std::string_view command = std::string_view(line).substr(begin);
  if (command.front() == '#') {
    take_ascii(command);
  } else {
    take_abbreviated(command);
  }
}

Response Console::execute(const ReadCommand& read) {
  ++commands_;
  const Response* const refusal = std::get_if<Response>(&read);
  Response response = refusal != nullptr ? *refusal : receiver_.execute(port_, std::get<Command>(read));
  if (!response.ok()) ++refused_;
  return response;
}

void Console::take_abbreviated(std::string_view line) {
  std::vector<std::string_view> words = split(line, " \t,");
  if (words.empty()) return;
  const std::string_view name = words.front();
  words.erase(words.begin());
  const Response response = execute(read_text_command(name, words));
  answer_text("<" + response.text + "\r\n" + prompt());
}

// "#LOGA,THISPORT,0,0,UNKNOWN,0,0.0,0,0,0;COM1,BESTPOSB,ONTIME,1.0*ec9ce601": of the header only the name counts.
void Console::take_ascii(std::string_view line) {
  const std::size_t star = line.find('*');
  const std::size_t semicolon = line.find(';');
  std::string_view name = line.substr(1, std::min(line.find_first_of(",;*"), line.size()) - 1);
  const bool is_command = name.ends_with('A') || name.ends_with('a');  // its format; R would be an answer
  if (is_command) name.remove_suffix(1);
  Response response = incorrect_message();
  if (!is_command || star == std::string_view::npos || semicolon == std::string_view::npos || semicolon > star) {
    ++commands_;
    ++refused_;
  } else {
    std::uint32_t sum = 0;
    const std::string_view digits = line.substr(star + 1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), sum, 16);
    const bool right = error == std::errc() && end == digits.data() + digits.size() && digits.size() == 8 &&
                       sum == oem::crc32(as_bytes(line.substr(1, star - 1)));
    const std::string_view fields = line.substr(semicolon + 1, star - semicolon - 1);
    response = execute(right ? read_text_command(name, split(fields, ", ")) : ReadCommand(invalid_checksum()));
  }
  answer_text(ascii_message(fmt::format("{}R", name), port_, receiver_.header(port_), response.text));
}

void Console::take_binary(std::uint8_t byte) {
  constexpr std::array<std::uint8_t, 3> kSync{0xAA, 0x44, 0x12};
  binary_.push_back(byte);
  const std::size_t size = binary_.size();
  if (size <= kSync.size() && byte != kSync[size - 1]) {
    binary_.clear();
    line_spoilt_ = true;
    if (byte == kSync.front() || byte == '\r' || byte == '\n') take(byte);
    return;
  }
  if (size < kMinHeader) return;
  const std::size_t header = binary_[3];
  const std::size_t total = header + read_little_endian<std::uint16_t>(binary_, 8) + kCrcBytes;
  if (header < kMinHeader || total > kMaxBinary) {
    ++refused_;
    binary_.clear();
    return;
  }
  if (size >= total) finish_binary();
}

void Console::finish_binary() {
  const std::vector<std::uint8_t> message = std::exchange(binary_, {});
  const std::span<const std::uint8_t> all(message);
  const std::size_t header = message[3];
  const std::uint16_t id = read_little_endian<std::uint16_t>(message, 4);
  const bool right =
      oem::crc32(all.first(all.size() - kCrcBytes)) == fsw::gnss::read_u32(message, all.size() - kCrcBytes);
  const Response response =
      execute(right ? read_binary_command(id, all.subspan(header, all.size() - header - kCrcBytes))
                    : ReadCommand(invalid_checksum()));
  std::vector<std::uint8_t> answer;
  oem::append_response(answer, receiver_.header(port_), id, response.id, response.text);
  receiver_.answer(port_, answer);
}

void Console::answer_text(const std::string& text) {
  receiver_.answer(port_, as_bytes(text));
}

}  // namespace vbar::grand::bench
