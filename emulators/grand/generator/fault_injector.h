#pragma once
// Injection of faults at their times or by command. Each is acknowledged when it has taken effect: on the control line
// and as one line of JSON in a file.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "emulators/common/faults.h"
#include "emulators/grand/control/control_servers.h"
#include "emulators/grand/generator/edge_broadcaster.h"
#include "emulators/grand/generator/generator_engine.h"
#include "emulators/grand/generator/scenario.h"

namespace vbar::grand::bench {

class FaultInjector {
 public:
  /// The faults act on the first three arguments, which outlive the injector. `file` receives a line for each fault
  /// that took effect. Throws std::runtime_error if it cannot be made.
  FaultInjector(GeneratorEngine& engine, ControlServers& control, EdgeBroadcaster& edges,
                const std::filesystem::path& file);

  /// Called with the line of the file (without its end) when the fault has taken effect.
  using Acknowledge = emulators::Acknowledge;
  void add(const Fault& fault, Acknowledge acknowledge = {});

  /// Begins faults that are due, detects their effects, ends those whose duration has passed. Called after every 100 ms
  /// of the generator and in between.
  void advance();

  /// Called for kBenchExit, after its acknowledgement.
  std::function<void()> on_exit;

 private:
  struct Active {
    Fault fault;
    Acknowledge acknowledge;
    bool has_begun = false;
    bool has_effect = false;
    bool has_ended = false;
    fsw::Duration begun = {};  ///< generator time; 0 before the run
    std::uint64_t count = 0;   ///< value of the effect's counter when it began
  };

  [[nodiscard]] fsw::Duration time_for(const Fault& fault) const;
  void begin(Active& active);
  void end(Active& active);
  [[nodiscard]] std::uint64_t effect_count(const Fault& fault) const;
  [[nodiscard]] bool has_effect(const Active& active) const;
  void acknowledge(Active& active);
  void set_line_fault(const Fault& fault, bool is_on);
  void set_control_faults();

  GeneratorEngine* engine_;
  ControlServers* control_;
  EdgeBroadcaster* edges_;
  emulators::FaultLog log_;
  std::vector<Active> active_;
};

}  // namespace vbar::grand::bench
