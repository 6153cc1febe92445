#pragma once
// Hashes that make two runs the same: SHA-256 over the bytes of all maneuver commands, and over those of all telemetry.

#include <cstdint>
#include <span>
#include <string>

#include "host_sim/files/sha256.h"

namespace vbar::report {

class OutputHash {
 public:
  /// A packet from the flight software, in its order. Its APID alone decides where it counts, so that a damaged packet
  /// changes the hash instead of vanishing from it. Packets to the flight software and step reports count nowhere.
  void add(std::span<const std::uint8_t> packet);

  /// Returns the hash of all packets so far, 64 lower-case hexadecimal digits.
  [[nodiscard]] std::string commands_sha256() const;
  [[nodiscard]] std::string telemetry_sha256() const;

 private:
  files::Sha256 commands_, telemetry_;
};

}  // namespace vbar::report
