#pragma once
// Location of the project's data files.

#include <filesystem>

namespace vbar::mission {

/// Returns $VBAR_DATA if set, else the data folder of the source tree this program was built from. Throws
/// std::runtime_error that names the folder if it does not exist.
std::filesystem::path data_directory();

}  // namespace vbar::mission
