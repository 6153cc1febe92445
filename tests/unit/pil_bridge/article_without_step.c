/* Has the functions of a test article but one. */
#include "fsw/messaging/vbar_gnc.h"

int32_t vbar_gnc_abi_version(void) {
  return VBAR_GNC_ABI_VERSION;
}
const char* vbar_gnc_name(void) {
  return "article without step";
}
size_t vbar_gnc_state_size(void) {
  return 1;
}
size_t vbar_gnc_state_alignment(void) {
  return 1;
}
vbar_status vbar_gnc_init(void* state, uint8_t spacecraft, vbar_packet_sink sink, void* sink_context) {
  (void)state;
  (void)spacecraft;
  (void)sink;
  (void)sink_context;
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
