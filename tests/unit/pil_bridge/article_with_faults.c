/* A test article that goes wrong in the way that its spacecraft number names. */
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include "fsw/gnc/vbar_gnc.h"

enum {
  kCrashesInStep = 1,
  kHangsInStep = 2,
  kExitsInStep = 3,
  kCrashesInInit = 4,
  kHangsInInit = 5,
  kFailsInStep = 6,
  kSendsGarbage = 7,
  kSendsNothing = 8
};

struct article {
  vbar_packet_sink sink;
  void* sink_context;
  uint8_t fault;
};

int32_t vbar_gnc_abi_version(void) {
  return VBAR_GNC_ABI_VERSION;
}
const char* vbar_gnc_name(void) {
  return "article with faults";
}
size_t vbar_gnc_state_size(void) {
  return sizeof(struct article);
}
size_t vbar_gnc_state_alignment(void) {
  return _Alignof(struct article);
}
vbar_status vbar_gnc_init(void* state, uint8_t spacecraft, vbar_packet_sink sink, void* sink_context) {
  struct article* self = state;
  self->sink = sink;
  self->sink_context = sink_context;
  self->fault = spacecraft;
  if (spacecraft == kCrashesInInit) (void)raise(SIGSEGV);
  while (spacecraft == kHangsInInit) (void)sleep(1);
  return 0;
}
void vbar_gnc_set_sink(void* state, vbar_packet_sink sink, void* sink_context) {
  (void)state;
  (void)sink;
  (void)sink_context;
}
vbar_status vbar_gnc_receive(void* state, const uint8_t* packet, size_t size) {
  (void)state;
  (void)packet;
  (void)size;
  return 0;
}
vbar_status vbar_gnc_step(void* state, int64_t gps_time_ns) {
  const struct article* self = state;
  const uint8_t fault = self->fault;
  static const uint8_t kGarbage[40] = {0xDE, 0xAD, 0xBE, 0xEF};
  (void)gps_time_ns;
  if (fault == kCrashesInStep) (void)raise(SIGSEGV);
  if (fault == kExitsInStep) exit(7);
  while (fault == kHangsInStep) (void)sleep(1);
  for (int k = 0; fault == kSendsGarbage && k < 3; ++k) self->sink(self->sink_context, kGarbage, sizeof kGarbage);
  return fault == kFailsInStep ? 12345 : 0;
}
