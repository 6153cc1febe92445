#pragma once
// Where the project's data files are.

#include <filesystem>

namespace vbar::mission {

/// $VBAR_DATA if set, else the data folder of the source tree this program was built from. Throws std::runtime_error
/// that names the folder if it is not there.
std::filesystem::path data_directory();

}  // namespace vbar::mission
