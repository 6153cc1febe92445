#pragma once
// Complete emulator: generator, receivers, their lines, control servers, edges and faults in one directory and one
// event loop.

#include <filesystem>
#include <memory>

#include <boost/asio/io_context.hpp>

#include "emulators/common/control_line.h"
#include "emulators/common/emulator_program.h"
#include "emulators/grand/generator/fault_injector.h"
#include "emulators/grand/generator/generator_engine.h"

namespace vbar::grand::bench {

class Bench {
 public:
  /// Makes all parts and, when it listens, writes DIR/addresses.json. The directory is made if it does not exist.
  /// Throws std::runtime_error, std::invalid_argument; each one sentence.
  Bench(boost::asio::io_context& context, const Scenario& scenario, const std::filesystem::path& data_directory,
        std::filesystem::path directory, const ReceiverFactory& make_receiver);
  /// Removes the files it made, except the list of faults, and writes the counters of the samples received.
  ~Bench();
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  [[nodiscard]] GeneratorEngine& engine() { return *engine_; }
  [[nodiscard]] ControlServers& control() { return *control_; }
  [[nodiscard]] FaultInjector& faults() { return *faults_; }

 private:
  void write_addresses(const Scenario& scenario) const;
  void write_counters() const;

  emulators::EmulatorDirectory directory_;
  std::unique_ptr<EdgeBroadcaster> edges_;
  std::unique_ptr<GeneratorEngine> engine_;
  std::unique_ptr<ControlServers> control_;
  std::unique_ptr<FaultInjector> faults_;
  std::unique_ptr<emulators::ControlLine> fault_line_;
};

}  // namespace vbar::grand::bench
