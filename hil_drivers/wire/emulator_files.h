#pragma once
// Files in the directory of an emulated testbed, which the emulator writes and the run reads.

namespace vbar::wire {

/// Addresses at which the emulator listens; their form is the testbed's. The file appears once all of them do.
inline constexpr const char* kAddressesFile = "addresses.json";

/// Faults that have taken effect, one JSON object a line.
inline constexpr const char* kFaultsFile = "faults.jsonl";

/// What the emulator counted during its life, one JSON object of numbers by name; written at its end.
inline constexpr const char* kCountersFile = "counters.json";

}  // namespace vbar::wire
