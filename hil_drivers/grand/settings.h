#pragma once
// [testbed.grand]: the GNSS testbed of a mission.

#include <cstdint>
#include <memory>
#include <string>

#include "fsw/core/gps_time.h"
#include "hil_drivers/grand/generators/generator.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::grand {

/// Value of testbed.grand.pps that means the socket named by the emulator.
inline constexpr const char* kEdgesOfBench = "socket";

struct GrandSettings : mission::TestbedSettings {
  const GeneratorKind* generator = nullptr;
  std::shared_ptr<const GeneratorSettings> generator_settings;
  std::string host = "127.0.0.1";
  std::uint16_t control_port =
      0;                       ///< of the generator, or of its first instance, the next follow; 0: as the bench says
  std::uint16_t hil_port = 0;  ///< 0: as the generator states
  fsw::Duration sample_period;
  fsw::Duration lead;  ///< a sample's own time before its sending; real time only
  fsw::Duration join;
  Pace pace = Pace::kLockStep;
  std::string pps;        ///< "none", a source of edges (pps/edge_source.h), or kEdgesOfBench
  std::string bench;      ///< command line of the emulator; empty: hardware, or an emulator that runs already
  fsw::Duration give_up;  ///< duration of a receiver's loss after which the run ends
  bool week_shift = false;
  std::string chrony;  ///< socket of chronyd's refclock SOCK, to which edges are forwarded; empty: none
};

/// Reads the table. Throws MissionError.
std::shared_ptr<const mission::TestbedSettings> read_grand(const mission::TableReader& section);

}  // namespace vbar::grand
