#pragma once
// Questions to an X server that SDL does not ask.

#include <string>

#include "hil_drivers/optical_stimulator/counts/picture.h"

struct _XDisplay;  // Xlib's Display, whose header defines common words as macros

namespace vbar::optical_stimulator {

/// Without it Xlib ends the program when the server goes away. `is_lost` is set then; it outlives the connection.
void survive_loss(_XDisplay* connection, bool& is_lost);

/// Returns when the server has executed all requests of the connection.
void wait_for_server(_XDisplay* connection);

/// The rectangle of the screen from (x, y) on, windows of all programs included. Throws std::runtime_error if a pixel
/// is not grey or the screen cannot be read.
[[nodiscard]] Picture read_screen(_XDisplay* connection, int x, int y, int width, int height);

/// Empty: every gamma ramp of the screen is an identity, or it has none. Else what is not.
[[nodiscard]] std::string gamma_complaint(_XDisplay* connection);

}  // namespace vbar::optical_stimulator
