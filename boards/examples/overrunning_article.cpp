// A test article for the supervision of steps: the step at GPS time t in nanoseconds takes t passes of a loop, so that
// a test chooses between a short step, one beyond its budget, and one that does not end in the lifetime of a
// spacecraft. It sends nothing; the board adds the step report.

#include <limits>
#include <new>

#include "fsw/core/result.h"
#include "fsw/messaging/vbar_gnc.h"

namespace {

using vbar::fsw::Status;

struct OverrunningArticle {
  std::int64_t turns = 0;  ///< sum over all steps, up to overflow
};

vbar_status as_c(Status status) {
  return static_cast<vbar_status>(status);
}

}  // namespace

extern "C" {

int32_t vbar_gnc_abi_version(void) {
  return VBAR_GNC_ABI_VERSION;
}
const char* vbar_gnc_name(void) {
  return "vbar step overrunner";
}
size_t vbar_gnc_state_size(void) {
  return sizeof(OverrunningArticle);
}
size_t vbar_gnc_state_alignment(void) {
  return alignof(OverrunningArticle);
}

vbar_status vbar_gnc_init(void* state, uint8_t /*spacecraft*/, vbar_packet_sink /*sink*/, void* /*sink_context*/) {
  ::new (state) OverrunningArticle;
  return as_c(Status::kOk);
}

void vbar_gnc_set_sink(void* /*state*/, vbar_packet_sink /*sink*/, void* /*sink_context*/) {}

vbar_status vbar_gnc_receive(void* /*state*/, const uint8_t* /*packet*/, size_t /*size*/) {
  return as_c(Status::kOk);
}

vbar_status vbar_gnc_step(void* state, int64_t gps_time_ns) {
  volatile std::int64_t& turns = static_cast<OverrunningArticle*>(state)->turns;
  for (std::int64_t turn = 0; turn < gps_time_ns; ++turn) {
    turns = turns == std::numeric_limits<std::int64_t>::max() ? 0 : turns + 1;
  }
  return as_c(Status::kOk);
}

}  // extern "C"
