#pragma once
// The link exerciser on every kind of flight computer, and what it must answer.

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pil_bridge/make_flight_computer.h"
#include "tests/support/paths.h"
#include "tests/support/step_packets.h"

namespace vbar::pil::test {

inline constexpr std::uint8_t kSpacecraft = 7;

inline FlightComputerOptions echo_options(Target target, LinkKind link) {
  FlightComputerOptions options;
  options.target = target;
  options.link = link;
  options.spacecraft = kSpacecraft;
  options.article = linked_test_article();
  if (target == Target::kHostProcess) options.image = vbar::tests::build_path("vbar_flight_echo");
  if (target == Target::kZynqQemu) options.image = vbar::tests::source_path("build/zynq/vbar_zynq7000_echo.elf");
  if (target == Target::kZynqLinuxQemu) options.image = vbar::tests::source_path("build/zynq-linux/vbar_flight_echo");
  return options;
}

/// The image of an emulated flight computer is built by a preset of its own: without it there is nothing to test.
inline bool has_image(const FlightComputerOptions& options) {
  return options.image.empty() || std::filesystem::exists(options.image);
}

/// What the link exerciser answers when called directly.
inline std::vector<Packet> expected_outputs(std::uint32_t steps) {
  return vbar::test::fly(*make_flight_computer(echo_options(Target::kInProcess, LinkKind::kSerial)), steps);
}

}  // namespace vbar::pil::test
