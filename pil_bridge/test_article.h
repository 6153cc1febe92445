#pragma once
// The functions of a test article (fsw/gnc/vbar_gnc.h), linked or loaded.

#include <memory>
#include <string>

#include "fsw/gnc/vbar_gnc.h"

// Optional functions: an article that is linked without them has null in their place.
extern "C" {
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

}  // namespace vbar::pil
