#pragma once
// Requests to an X server that SDL does not make.

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "hil_drivers/optical_stimulator/pictures/display_light.h"

struct _XDisplay;  // Xlib's Display, whose header defines common words as macros

namespace vbar::optical_stimulator {

/// Survives the loss of the server: by default Xlib then ends the program. `is_lost` is set then; it outlives the
/// connection.
void survive_loss(_XDisplay* connection, bool& is_lost);

/// Sets a time limit to requests while it lives: beyond it the connection is shut down, which ends them as
/// the loss of a server does (survive_loss). A server that is stopped would block them forever.
class AnswerLimit {
 public:
  /// Sets `is_expired` when the limit is exceeded.
  AnswerLimit(_XDisplay* connection, std::chrono::milliseconds limit, bool& is_expired);
  ~AnswerLimit();
  AnswerLimit(const AnswerLimit&) = delete;
  AnswerLimit& operator=(const AnswerLimit&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable over_;
  bool is_over_ = false;
  std::thread thread_;  // last: it uses all the others
};

/// Returns when the server has executed all requests of the connection.
void wait_for_server(_XDisplay* connection);

/// Reads the rectangle of the screen from (x, y) on, windows of all programs included. Throws std::runtime_error if a
/// pixel is not grey or the screen cannot be read.
[[nodiscard]] Picture read_screen(_XDisplay* connection, int x, int y, int width, int height);

/// Returns the gamma ramp of the screen that is not an identity; empty: every one is an identity, or the screen has
/// none.
[[nodiscard]] std::string gamma_complaint(_XDisplay* connection);

}  // namespace vbar::optical_stimulator
