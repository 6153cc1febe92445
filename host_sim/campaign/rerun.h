#pragma once
// Flies one case again, with all its records, and compares its outputs with those on record.

#include <filesystem>
#include <functional>
#include <string>

#include "host_sim/campaign/case_state.h"

namespace vbar::campaign {

struct Rerun {
  enum class Verdict { kIdentical, kDifferent, kNothingToCompare, kFailed, kInterrupted };
  Verdict verdict = Verdict::kFailed;
  std::string sentence;
  std::filesystem::path folder = {};  ///< run folder; empty if none stays
};

/// `out` empty: runs/NUMBER of the campaign. Throws app::Refused for an unknown case, a folder in use or, unless it is
/// trusted, one that would execute another program (trust.h), std::runtime_error if it cannot be flown here.
[[nodiscard]] Rerun rerun(const Folder& folder, std::size_t number, const std::filesystem::path& out, bool is_trusted,
                          const std::function<bool()>& stop_requested);

}  // namespace vbar::campaign
