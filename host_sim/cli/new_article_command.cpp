#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/core.h>

#include "host_sim/cli/commands.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::app {
namespace {

namespace fs = std::filesystem;

struct Language {
  std::string_view name;
  const char* example;  ///< below the folder that data and missions are in
};
constexpr std::array kLanguages{Language{"c", "boards/examples/c_article/article.c"},
                                Language{"c++", "boards/examples/cpp_article/article.cpp"}};

const Language& language_of(const std::string& name) {
  for (const Language& language : kLanguages)
    if (language.name == name) return language;
  throw Refused(fmt::format("--language {}: accepted: c, c++", name));
}

std::string content_of(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  return text.str();
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream stream(file);
  stream << text;
  stream.close();
  if (!stream) throw std::runtime_error(file.string() + ": cannot be written");
}

/// A name of a CMake target and of a library.
std::string checked_name(const fs::path& folder) {
  const std::string name = (folder.has_filename() ? folder : folder.parent_path()).filename().string();
  const auto is_allowed = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  if (name.empty() || !std::ranges::all_of(name, is_allowed))
    throw Refused(
        fmt::format("{}: the folder's name becomes that of the flight software; accepted: letters, digits, _ and -",
                    folder.string()));
  return name;
}

}  // namespace

int new_article_command(const NewArticleOptions& options) {
  const std::string name = checked_name(options.folder);
  const Language& language = language_of(options.language);
  if (fs::exists(options.folder) && !(fs::is_directory(options.folder) && fs::is_empty(options.folder)))
    throw Refused(options.folder.string() + ": exists; a new or an empty folder is accepted");
  const fs::path share = mission::data_directory().parent_path();
  const fs::path templates = share / "toolchains/package/article";
  const fs::path example = share / language.example;
  // share/vbar of an installation; a source tree has no package.
  const bool is_installed = share.filename() == "vbar" && share.parent_path().filename() == "share";
  const std::string prefix = is_installed ? share.parent_path().parent_path().string() : "PREFIX";
  const std::string source = name + example.extension().string();
  fs::create_directories(options.folder);
  for (const char* const file : {"CMakeLists.txt", "README.md"}) {
    std::string text = content_of(templates / (std::string(file) + ".in"));
    text = files::replaced(text, "@NAME@", name);
    text = files::replaced(text, "@SOURCE@", source);
    text = files::replaced(text, "@PREFIX@", prefix);
    write(options.folder / file, text);
  }
  write(options.folder / source, content_of(example));
  fmt::print("{}: CMakeLists.txt, README.md with the commands, {}\n", options.folder.string(), source);
  return kDone;
}

}  // namespace vbar::app
