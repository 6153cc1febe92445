#include "host_sim/observation_files/observation_types.h"

#include <fmt/format.h>

namespace vbar::observation_files {
namespace {

constexpr std::string_view kTypesOfVersion2 = "# / TYPES OF OBSERV";
constexpr std::string_view kTypesOfVersion3 = "SYS / # / OBS TYPES";

}  // namespace

std::string_view label_of(const files::TextLines& lines) {
  return files::trimmed(lines.columns(61, 80));
}

int observation_version(const files::TextLines& lines) {
  if (label_of(lines) != "RINEX VERSION / TYPE") lines.refuse("RINEX VERSION / TYPE in columns 61 to 80");
  const double version = lines.number_in(1, 9, "the version of RINEX");
  if (!(version >= 2.0 && version < 5.0)) lines.refuse(fmt::format("RINEX version {}", version), "2, 3 or 4");
  if (lines.columns(21, 21) != "O")
    lines.refuse(fmt::format("a file of type {}", files::quoted(files::trimmed(lines.columns(21, 40)))),
                 "observation data (O)");
  return static_cast<int>(version);
}

void ObservationTypes::take_words(const files::TextLines& lines, std::size_t first, std::size_t width,
                                  std::size_t per_line) {
  std::vector<std::string>& list = types_[system_];
  for (std::size_t k = 0; k < per_line && list.size() < static_cast<std::size_t>(announced_); ++k) {
    const std::string_view word = files::trimmed(lines.columns(first + width * k, first + width * (k + 1) - 1));
    if (word.empty())
      lines.refuse(fmt::format("type {} of {} left blank", list.size() + 1, announced_), "a type, as C1 or L1C");
    list.emplace_back(word);
  }
  is_open_ = list.size() < static_cast<std::size_t>(announced_);
}

void ObservationTypes::take(const files::TextLines& lines) {
  const bool is_old = version_ == 2;
  if (label_of(lines) != (is_old ? kTypesOfVersion2 : kTypesOfVersion3)) return;
  const std::string_view number = is_old ? lines.columns(1, 6) : lines.columns(4, 6);
  if (files::trimmed(number).empty()) {
    if (!is_open_) lines.refuse("more types than their number", "a number of types first");
  } else {
    check_complete(lines);
    announced_ = lines.integer_in(is_old ? 1 : 4, 6, "the number of types");
    if (announced_ < 1 || announced_ > kMaxTypes)
      lines.refuse(fmt::format("{} types", announced_), fmt::format("1 to {}", kMaxTypes));
    system_ = is_old ? ' ' : lines.columns(1, 1).front();
    if (!is_old && (system_ < 'A' || system_ > 'Z')) lines.refuse("the letter of a system in column 1");
    types_[system_].clear();
  }
  if (is_old) {
    take_words(lines, 7, 6, 9);
  } else {
    take_words(lines, 7, 4, 13);
  }
}

void ObservationTypes::check_complete(const files::TextLines& lines) const {
  if (is_open_) lines.refuse(fmt::format("{} of {} types", types_.at(system_).size(), announced_), "all of them");
}

const std::vector<std::string>& ObservationTypes::of(char system) const {
  static const std::vector<std::string> kNone;
  const auto found = types_.find(version_ == 2 ? ' ' : system);
  return found == types_.end() ? kNone : found->second;
}

}  // namespace vbar::observation_files
