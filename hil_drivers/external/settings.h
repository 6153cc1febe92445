#pragma once
// [testbed.external]: sensors of a mission that are programs of the user's own.

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::external {

/// Where the program of a source is: started by the run, or waiting for it at an address.
struct Program {
  std::string command;     ///< empty: at the address
  std::string host;        ///< IPv4 address
  std::uint16_t port = 0;  ///< UDP
};

struct ProgramOfSource {
  std::string source;  ///< "servicer/gnss"
  Program program;
};

struct ExternalSettings : mission::TestbedSettings {
  Program program;  ///< of every source without one of its own
  std::vector<ProgramOfSource> sources;
  std::chrono::milliseconds start_limit{30000};   ///< for the first answer
  std::chrono::milliseconds answer_limit{10000};  ///< for each of the following
  double memory_gib = 8.0;                        ///< limit of each program that is started

  /// Null: the mission names none for it.
  [[nodiscard]] const Program* program_of(std::string_view source) const;
};

/// Throws MissionError.
std::shared_ptr<const mission::TestbedSettings> read_external(const mission::TableReader& section);

}  // namespace vbar::external
