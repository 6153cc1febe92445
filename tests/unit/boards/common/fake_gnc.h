#pragma once
// A test article for the executive's tests: all its outputs depend on every byte of its inputs, in order, so that a
// packet that is lost, repeated, swapped or altered on the way changes all of its later output.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "fsw/messaging/vbar_gnc.h"

namespace vbar::testing {

using Bytes = std::vector<std::uint8_t>;

/// What the fake claims and does; set by a test before it says hello.
struct FakeGncSettings {
  std::int32_t abi_version = VBAR_GNC_ABI_VERSION;
  std::size_t state_size = 64;
  std::size_t state_alignment = 8;
  vbar_status init_status = 0;
  /// Packets of a step, given the digest of all inputs; the default says up to 70 short packets.
  std::function<std::vector<Bytes>(std::uint64_t digest)> step_output;
  /// Packets said while it is made.
  std::vector<Bytes> init_output;
  vbar_status authenticate_status = 0;
  std::uint64_t sequence_reached = 0;  ///< of the telecommands that it claims to have accepted
};

/// What it was given by vbar_gnc_authenticate since reset_fake_gnc(), call by call.
struct FakeKey {
  Bytes key;
  std::uint16_t index = 0;
  std::uint64_t sequence = 0;
};
std::vector<FakeKey>& fake_gnc_keys();

FakeGncSettings& fake_gnc_settings();

/// Back to a fake that fits, and steps() to zero.
void reset_fake_gnc();

/// Calls of vbar_gnc_step since reset_fake_gnc().
int fake_gnc_steps();

/// A packet (telemetry health) whose bytes depend on `digest` and `number`.
Bytes fake_output(std::uint64_t digest, int number);

}  // namespace vbar::testing
