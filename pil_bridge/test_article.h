#pragma once
// The functions of a test article (fsw/messaging/vbar_gnc.h), linked or loaded.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "fsw/messaging/vbar_gnc.h"
#include "fsw/packets/security_trailer.h"
#include "pil_bridge/flight_computer.h"

// Optional functions: an article that is linked without them has null in their place.
extern "C" {
[[gnu::weak]] vbar_status vbar_gnc_authenticate(void* state, const uint8_t* key, uint16_t index, uint64_t sequence);
[[gnu::weak]] size_t vbar_gnc_snapshot_size(void);
[[gnu::weak]] vbar_status vbar_gnc_save(const void* state, uint8_t* snapshot, size_t size);
[[gnu::weak]] vbar_status vbar_gnc_restore(void* state, const uint8_t* snapshot, size_t size);
}

namespace vbar::pil {

struct TestArticle {
  decltype(&vbar_gnc_abi_version) abi_version = nullptr;
  decltype(&vbar_gnc_name) name = nullptr;
  decltype(&vbar_gnc_state_size) state_size = nullptr;
  decltype(&vbar_gnc_state_alignment) state_alignment = nullptr;
  decltype(&vbar_gnc_init) init = nullptr;
  decltype(&vbar_gnc_set_sink) set_sink = nullptr;
  decltype(&vbar_gnc_receive) receive = nullptr;
  decltype(&vbar_gnc_step) step = nullptr;
  decltype(&vbar_gnc_authenticate) authenticate = nullptr;  ///< null in an article without authentication
  // null in an article without snapshots
  decltype(&vbar_gnc_snapshot_size) snapshot_size = nullptr;
  decltype(&vbar_gnc_save) save = nullptr;
  decltype(&vbar_gnc_restore) restore = nullptr;
};

/// The test article linked with this program. Inline, so that only a program that calls it needs one.
inline std::shared_ptr<const TestArticle> linked_test_article() {
  return std::make_shared<const TestArticle>(TestArticle{.abi_version = &vbar_gnc_abi_version,
                                                         .name = &vbar_gnc_name,
                                                         .state_size = &vbar_gnc_state_size,
                                                         .state_alignment = &vbar_gnc_state_alignment,
                                                         .init = &vbar_gnc_init,
                                                         .set_sink = &vbar_gnc_set_sink,
                                                         .receive = &vbar_gnc_receive,
                                                         .step = &vbar_gnc_step,
                                                         .authenticate = &vbar_gnc_authenticate,
                                                         .snapshot_size = &vbar_gnc_snapshot_size,
                                                         .save = &vbar_gnc_save,
                                                         .restore = &vbar_gnc_restore});
}

/// The file of a library: itself, if it is a path; a name alone, as vbar_gnc_winged_box, is that of lib<name>.so beside
/// the running program or, of an installation, in lib/vbar of its prefix.
std::string library_file(const std::string& library);

/// The test article in the shared library `library` (library_file), which stays loaded during the lifetime of the
/// result. Throws FlightComputerError if it cannot be loaded, lacks a function, or was built for another version of the
/// interface.
std::shared_ptr<const TestArticle> load_test_article(const std::string& library);

// The flight software in this process, called through its C interface. The order of its inputs, and the handling of
// its output, follow boards/common/flight_executive.cpp, so that the result is the same as on a board.

/// `security`: demanded of telecommands, if not null. Throws FlightComputerError if the article refuses to start, or
/// cannot authenticate telecommands that are to be.
std::unique_ptr<FlightComputer> make_in_process(std::shared_ptr<const TestArticle> article, std::uint8_t spacecraft,
                                                const fsw::packets::TelecommandSecurity* security = nullptr);

// A flight computer in a child process, so that foreign flight software that crashes or never returns ends neither the
// run's record nor the program. The price is two messages over a socket for each step; vbar's own flight software,
// whose loops are bounded, therefore stays in the process of the simulation.

/// Calls `make` in a child process and hands every step over to what it makes. `name` is that of the flight software in
/// messages. Throws FlightComputerError, here and from step(): what was thrown there, or that the software crashed or
/// did not return within `step_limit`, or within a second of a signal to this process. The child has `memory_bytes`
/// beside what it shares with this process; 0: no limit. Processes that it leaves behind in its group are ended with
/// it.
std::unique_ptr<FlightComputer> make_guarded(const std::function<std::unique_ptr<FlightComputer>()>& make,
                                             const std::string& name, std::chrono::milliseconds step_limit,
                                             std::uint64_t memory_bytes = 0);

}  // namespace vbar::pil
