#pragma once
// Complete program of a flight computer under a POSIX system.

namespace vbar::boards::posix {

/// Parses the command line, opens the link and flies until the host sends goodbye or ends. `name` is reported to the
/// host. Returns the exit status: 0 after either, 1 if the link failed, 2 for an invalid command line.
int flight_main(const char* name, int argc, char** argv);

}  // namespace vbar::boards::posix
