#pragma once
// Where the project's data files are.

#include "host_sim/mission/data_directory.h"

namespace vbar::app {

using mission::data_directory;

}  // namespace vbar::app
