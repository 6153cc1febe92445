#pragma once
// The running program's own file, and the programs beside it. A portable bundle starts its programs by a loader of its
// own: /proc/self/exe is that loader then.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace vbar::files {

/// Returns the path of this program; empty if the system does not state it.
[[nodiscard]] std::filesystem::path own_program();

/// Returns the path to read the bytes of this program, also after another build took its place.
[[nodiscard]] std::filesystem::path own_program_bytes();

/// "vbar_NAME" in the folder of this program; empty if there is none that can be executed, or if it is this program.
[[nodiscard]] std::filesystem::path program_beside(std::string_view name);

/// The words that start a program of the same build: its path, after the loader with its libraries if this program was
/// started by one.
[[nodiscard]] std::vector<std::string> words_that_start(const std::filesystem::path& program);

/// Lets a program of the same build take the place of this one. Returns, with a sentence, only if that fails.
[[nodiscard]] std::string become(const std::filesystem::path& program, std::vector<std::string> arguments);

}  // namespace vbar::files
