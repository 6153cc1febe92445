#pragma once
// Who sees the packets of a run: the log, the hashes, and, when asked, the LCM bus.

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

  /// The run has ended, and everything is in the files. Throws std::runtime_error that names the one that takes no
  /// more.
  void finish();

  /// Of the maneuver commands, and of all telemetry, so far.
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
