#pragma once
// Recorders of the packets of a run: the log, the hashes and, if the mission asks for it, the LCM bus.

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host_sim/app/run_observer.h"
#include "host_sim/mission/mission.h"
#include "host_sim/twins/packet_log.h"

namespace vbar::app {

class PacketKeepers {
 public:
  /// Starts packets.lcmlog in `folder` and the LCM mirror, each if the mission asks for it. `check` is that of the log.
  /// Throws std::runtime_error.
  PacketKeepers(const mission::Mission& mission, const std::filesystem::path& folder, twins::EventCheck check = {});
  ~PacketKeepers();
  PacketKeepers(const PacketKeepers&) = delete;
  PacketKeepers& operator=(const PacketKeepers&) = delete;

  [[nodiscard]] std::span<RunObserver* const> observers() const { return observers_; }

  /// Writes everything to the files at the end of the run. Throws std::runtime_error that names a file that cannot be
  /// written.
  void finish();

  /// Returns the SHA-256 of the maneuver commands, and that of all telemetry, so far.
  [[nodiscard]] std::string commands_sha256() const;
  [[nodiscard]] std::string telemetry_sha256() const;

 private:
  class Log;
  class Hash;
  class Mirror;
  std::unique_ptr<Log> log_;
  std::unique_ptr<Hash> hash_;
  std::unique_ptr<Mirror> mirror_;
  std::vector<RunObserver*> observers_;
};

}  // namespace vbar::app
