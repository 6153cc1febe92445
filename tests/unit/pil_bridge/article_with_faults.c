/* A test article that goes wrong in the way that its spacecraft number names. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "fsw/messaging/vbar_gnc.h"

enum {
  kCrashesInStep = 1,
  kHangsInStep = 2,
  kExitsInStep = 3,
  kCrashesInInit = 4,
  kHangsInInit = 5,
  kReturnsErrors = 6,
  kAllocates = 7,
  kForks = 8,
  kSendsNothing = 9,
  kSendsGarbage = 10,
  kForksSession = 11,
  kWritesToDescriptors = 12
};
enum { kStatus = 12345 };

static vbar_packet_sink the_sink;
static void* the_context;

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
  the_sink = sink;
  the_context = sink_context;
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
  (void)packet;
  (void)size;
  return *(const uint8_t*)state == kReturnsErrors ? kStatus : 0;
}
vbar_status vbar_gnc_step(void* state, int64_t gps_time_ns) {
  const uint8_t fault = *(const uint8_t*)state;
  (void)gps_time_ns;
  if (fault == kCrashesInStep) (void)raise(SIGSEGV);
  if (fault == kExitsInStep) exit(7);
  while (fault == kHangsInStep) (void)sleep(1);
  static const uint8_t kGarbage[40] = {0xDE, 0xAD, 0xBE, 0xEF};
  for (int k = 0; fault == kSendsGarbage && k < 3; ++k) the_sink(the_context, kGarbage, sizeof kGarbage);
  if (fault == kReturnsErrors) {
    the_sink(the_context, (const uint8_t*)"garbage", 7);
    the_sink(the_context, (const uint8_t*)"", 0); /* not of a packet's size: dropped */
    return kStatus;
  }
  for (int mebibyte = 0; fault == kAllocates && mebibyte < 4096; ++mebibyte) {
    volatile char* const memory = malloc(1 << 20);
    for (int at = 0; at < 1 << 20; at += 4096) memory[at] = 1;
  }
  for (int descriptor = 3; fault == kWritesToDescriptors && descriptor < 64; ++descriptor)
    (void)!write(descriptor, "\xFF\xFF\xFF\xFFgarbage", 11);
  if (fault == kForks || fault == kForksSession) {
    const pid_t child = fork();
    if (child == 0 && fault == kForksSession) (void)setsid();
    while (child == 0) (void)pause();
    char text[16];
    const int size = snprintf(text, sizeof text, "%d", (int)child);
    the_sink(the_context, (const uint8_t*)text, (size_t)size);
  }
  return 0;
}
