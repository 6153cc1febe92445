/* A test article that goes wrong in the way that its spacecraft number names. */
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include "fsw/gnc/vbar_gnc.h"

enum { kCrashesInStep = 1, kHangsInStep = 2, kExitsInStep = 3, kCrashesInInit = 4, kHangsInInit = 5 };

int32_t vbar_gnc_abi_version(void) {
  return VBAR_GNC_ABI_VERSION;
}
const char* vbar_gnc_name(void) {
  return "article with faults";
}
size_t vbar_gnc_state_size(void) {
  return 1;
}
size_t vbar_gnc_state_alignment(void) {
  return 1;
}
vbar_status vbar_gnc_init(void* state, uint8_t spacecraft, vbar_packet_sink sink, void* sink_context) {
  (void)sink;
  (void)sink_context;
  *(uint8_t*)state = spacecraft;
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
  const uint8_t fault = *(const uint8_t*)state;
  (void)gps_time_ns;
  if (fault == kCrashesInStep) (void)raise(SIGSEGV);
  if (fault == kExitsInStep) exit(7);
  while (fault == kHangsInStep) (void)sleep(1);
  return 0;
}
