#pragma once
// A data file as a mission names it.

#include <filesystem>
#include <string>

namespace vbar::mission {

struct NamedFile {
  std::string where;           ///< "file:line" or "--set path=value"
  std::string key;             ///< dotted path
  std::string text;            ///< the value
  std::filesystem::path file;  ///< absolute, or in the data folder
};

}  // namespace vbar::mission
