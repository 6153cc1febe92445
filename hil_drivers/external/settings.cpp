#include "hil_drivers/external/settings.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <arpa/inet.h>

namespace vbar::external {
namespace {

using mission::from_to;
using mission::TableReader;

/// "127.0.0.1:5005"
void read_address(const TableReader& section, Program& program) {
  const std::string text = section.text("udp", "");
  if (text.empty()) return;
  const std::size_t colon = text.rfind(':');
  const std::string_view digits = colon == std::string::npos ? "" : std::string_view(text).substr(colon + 1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), program.port);
  program.host = text.substr(0, colon);
  in_addr ignored{};
  if (error != std::errc{} || end != digits.data() + digits.size() || program.port == 0 ||
      ::inet_pton(AF_INET, program.host.c_str(), &ignored) != 1)
    section.refuse_value("udp", "an IPv4 address and a port, \"127.0.0.1:5005\"");
}

Program read_program(const TableReader& section, bool is_required) {
  Program program;
  program.command = section.text("program", "");
  read_address(section, program);
  const bool has_command = program.command.find_first_not_of(' ') != std::string::npos;
  if (has_command && program.port != 0) section.refuse_value("udp", "nothing beside program");
  if (is_required && !has_command && program.port == 0)
    section.refuse("program", "neither program nor udp",
                   "the command line of a program, or the address at which one waits");
  if (!has_command) program.command.clear();
  return program;
}

}  // namespace

const Program* ExternalSettings::program_of(std::string_view source) const {
  const auto own = std::ranges::find(sources, source, &ProgramOfSource::source);
  if (own != sources.end()) return &own->program;
  return program.command.empty() && program.port == 0 ? nullptr : &program;
}

std::shared_ptr<const mission::TestbedSettings> read_external(const TableReader& section) {
  auto settings = std::make_shared<ExternalSettings>();
  const std::vector<TableReader> sources = section.tables("source");
  settings->program = read_program(section, sources.empty());
  for (const TableReader& source : sources) {
    ProgramOfSource own{source.text("name"), read_program(source, true)};
    if (std::ranges::find(settings->sources, own.source, &ProgramOfSource::source) != settings->sources.end())
      source.refuse_value("name", "each source once");
    settings->sources.push_back(std::move(own));
    source.finish();
  }
  const auto limit = [&](std::string_view key, double default_s) {
    return std::chrono::milliseconds(section.span(key, 1.0, from_to(0.1, 3600.0), default_s).ns / 1000000);
  };
  settings->start_limit = limit("start_limit_s", 30.0);
  settings->answer_limit = limit("answer_limit_s", 10.0);
  settings->memory_gib = section.number("memory_gib", from_to(0.1, 1024.0), settings->memory_gib);
  section.finish();
  return settings;
}

}  // namespace vbar::external
