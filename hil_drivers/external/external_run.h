#pragma once
// [testbed.external]: sensors of a mission that are programs of the user.

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/sensors/testbed.h"

namespace vbar::external {

/// Program of a source: started by the run, or waiting for it at an address.
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
  Program program;  ///< program of every source that has none of its own
  std::vector<ProgramOfSource> sources;
  std::chrono::milliseconds start_limit{30000};   ///< limit for the first answer
  std::chrono::milliseconds answer_limit{10000};  ///< limit for each of the following
  double memory_gib = 8.0;                        ///< limit for each program that is started

  /// Returns the program of a source; null: the mission names none for it.
  [[nodiscard]] const Program* program_of(std::string_view source) const;
};

/// Reads the table. Throws MissionError.
std::shared_ptr<const mission::TestbedSettings> read_external(const mission::TableReader& section);

extern const testbeds::TestbedKind kExternal;

}  // namespace vbar::external
