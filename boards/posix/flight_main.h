#pragma once
// The whole program of a flight computer under a POSIX system.

namespace vbar::boards::posix {

/// Parses the command line, opens the link and flies until the host says goodbye or is gone. `name` is what the host
/// sees. Returns the exit status: 0 after either, 1 if the link failed, 2 for a command line that is not understood.
int flight_main(const char* name, int argc, char** argv);

}  // namespace vbar::boards::posix
