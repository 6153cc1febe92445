/* The test article, as C: what a board or a simulation needs of a flight software, and all it may use.
 *
 * vbar's own GNC implements it (fsw/gnc). So can another stack in C, C++, Rust or generated code: as a shared library
 * that `flight_computer.library` names on the host, or linked into a board image instead of vbar's.
 *
 * Rules for an implementation: its whole state is one plain object of vbar_gnc_state_size() bytes in memory the caller
 * owns; no heap, no clock, no threads, no I/O; what it does with a packet depends on the packet's time tag and the step
 * it was delivered in, not on the order of arrival within the step. */
#ifndef VBAR_FSW_GNC_VBAR_GNC_H
#define VBAR_FSW_GNC_VBAR_GNC_H

/* C first. NOLINTBEGIN(modernize-*) */
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version of this header, which added the snapshot; a caller that takes none accepts VBAR_GNC_ABI_VERSION_MIN too. */
#define VBAR_GNC_ABI_VERSION 2
#define VBAR_GNC_ABI_VERSION_MIN 1

/* 0: done. Otherwise the reason, as in fsw/core/result.h (`Status`). */
typedef int32_t vbar_status;

/* Takes one outgoing space packet of `size` bytes; the bytes are the caller's only during the call. */
typedef void (*vbar_packet_sink)(void* context, const uint8_t* packet, size_t size);

/* VBAR_GNC_ABI_VERSION that the implementation was built with. */
int32_t vbar_gnc_abi_version(void);

/* Name and version for reports; a string constant. */
const char* vbar_gnc_name(void);

/* Size and alignment (bytes) of the state object. */
size_t vbar_gnc_state_size(void);
size_t vbar_gnc_state_alignment(void);

/* Makes a new flight software for spacecraft number `spacecraft` in `state`; packets go to `sink`. */
vbar_status vbar_gnc_init(void* state, uint8_t spacecraft, vbar_packet_sink sink, void* sink_context);

/* Gives another sink to a state that was restored from a copy of its bytes. */
void vbar_gnc_set_sink(void* state, vbar_packet_sink sink, void* sink_context);

/* Delivers one space packet. A refused packet (status not 0) has changed nothing but a counter. */
vbar_status vbar_gnc_receive(void* state, const uint8_t* packet, size_t size);

/* Runs the step at `gps_time_ns` on the packets received since the last one. */
vbar_status vbar_gnc_step(void* state, int64_t gps_time_ns);

/* Authentication of telecommands (docs/wire_formats.md). It is optional: an implementation without these two functions
 * accepts every telecommand, and a caller that has a key does not start it. */
#define VBAR_GNC_KEY_BYTES 32

/* Demands a security trailer of every telecommand from here on: of this key (VBAR_GNC_KEY_BYTES bytes, which the
 * caller need not retain) and index, with sequence numbers above `sequence`. To be called after vbar_gnc_init, before
 * the first packet. The key reaches the computer by this call only, never by the link, and no snapshot contains it. */
vbar_status vbar_gnc_authenticate(void* state, const uint8_t* key, uint16_t index, uint64_t sequence);

/* The sequence number that the next telecommand must exceed, which a computer passes on when it starts a new state: it
 * would otherwise accept the telecommands of the session before once more. 0 without a key. */
uint64_t vbar_gnc_telecommand_sequence(const void* state);

/* The snapshot is what a computer retains through a reboot: a header with version, size, step, time and checksum, and
 * the state with its workspaces, without addresses, in the representation of the computer and the build that made it.
 * It is optional: an implementation without these three functions cannot be restored. */

/* Size (bytes) of a snapshot. */
size_t vbar_gnc_snapshot_size(void);

/* Writes the snapshot after a step; packets received since are not part of it. kTooShort (fsw/core/result.h) if `size`
 * is below vbar_gnc_snapshot_size(), kNotReady before the first step. */
vbar_status vbar_gnc_save(const void* state, uint8_t* snapshot, size_t size);

/* Restores a state that vbar_gnc_init has just made, with its sink and spacecraft number. The next step continues from
 * a snapshot that is at most 600 s older; of an older one it keeps the telecommands only. A snapshot that is truncated
 * (kTooShort), of another layout, version or spacecraft (kWrongType) or damaged (kBadChecksum) is refused and leaves a
 * cold state, whose next step reports the refusal. With a key, one of another key or without one is damaged, and the
 * sequence number of telecommands is the larger of the two. */
vbar_status vbar_gnc_restore(void* state, const uint8_t* snapshot, size_t size);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(modernize-*) */

#endif
