#pragma once
// Ctrl-C ends a run between two steps, so that its folder is left whole and says that it is incomplete.

namespace vbar::app {

/// From now on SIGINT, SIGTERM and SIGHUP only set a flag; a second one ends the program. A reader of standard output
/// that goes away does not end the program.
void catch_stop_signals();

[[nodiscard]] bool stop_requested();

}  // namespace vbar::app
