#pragma once
// Sender of PPS edges on a Unix datagram socket: the emulator's end of edge_source.h.

#include <cstdint>
#include <memory>
#include <string>

#include "hil_drivers/grand/wire/pps_datagram.h"

namespace vbar::grand {

class EdgeBroadcaster {
 public:
  /// Binds `path`, where a socket that an ended program left is replaced. Throws std::runtime_error.
  explicit EdgeBroadcaster(const std::string& path);
  ~EdgeBroadcaster();  ///< removes the socket's file
  EdgeBroadcaster(const EdgeBroadcaster&) = delete;
  EdgeBroadcaster& operator=(const EdgeBroadcaster&) = delete;

  /// Accepts the clients that have subscribed since the last call, and sends the edge to all: once, unless a fault
  /// below is pending. Does not wait: an edge that a subscriber's queue does not accept is lost for that subscriber.
  void send(const wire::PpsDatagram& edge);

  // Faults that act from the next edge on.
  void miss(unsigned edges) { missing_ += edges; }        ///< are not sent
  void repeat(unsigned edges) { doubled_ += edges; }      ///< are sent twice
  void jump(fsw::Duration by) { jump_ = jump_ + by; }     ///< all later edges are labelled `by` later
  void delay(fsw::Duration by) { delay_ = delay_ + by; }  ///< the next edge alone has a time stamp that is `by` late

  [[nodiscard]] std::size_t subscribers() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
  unsigned missing_ = 0;
  unsigned doubled_ = 0;
  fsw::Duration jump_;
  fsw::Duration delay_;
};

}  // namespace vbar::grand
