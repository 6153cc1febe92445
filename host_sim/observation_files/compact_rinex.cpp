
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/observation_files/observation_types.h"
#include "host_sim/observation_files/rinex_observations.h"

namespace vbar::observation_files {
namespace {

constexpr std::string_view kLabel = "CRINEX VERS   / TYPE";
constexpr std::size_t kHighestOrder = 9;

/// Applies the changes of a line: a blank keeps a character, & makes it blank, any other replaces it.
void change_text(std::string& text, std::string_view changes) {
  if (changes.size() > text.size()) text.resize(changes.size(), ' ');
  for (std::size_t k = 0; k < changes.size(); ++k)
    if (changes[k] != ' ') text[k] = changes[k] == '&' ? ' ' : changes[k];
}

void drop_blanks_at_end(std::string& text) {
  text.erase(text.find_last_not_of(' ') + 1);
}

/// An integer that is the sum of its differences: value, first difference, ...
class DifferenceArc {
 public:
  [[nodiscard]] bool is_open() const { return is_open_; }
  void close() { is_open_ = false; }

  void open(std::size_t order, std::int64_t value) {
    is_open_ = true;
    order_ = order;
    known_ = 0;
    values_[0] = value;
  }

  /// Adds the difference of the highest order that is known by then; false if a sum overflows.
  [[nodiscard]] bool add(std::int64_t difference) {
    if (known_ < order_) ++known_;
    values_[known_] = difference;
    for (std::size_t k = known_; k > 0; --k)
      if (__builtin_add_overflow(values_[k - 1], values_[k], &values_[k - 1])) return false;
    return true;
  }

  [[nodiscard]] std::int64_t value() const { return values_[0]; }

 private:
  bool is_open_ = false;
  std::size_t order_ = 0, known_ = 0;
  std::array<std::int64_t, kHighestOrder + 1> values_{};
};

/// What is known of a satellite from the epoch before.
struct SatelliteArcs {
  std::vector<DifferenceArc> arcs;  ///< of each type
  std::string flags;                ///< two characters of each type
};

class Expander {
 public:
  Expander(std::string_view text, const std::string& file) : lines_(text, file) {}

  std::string expand() {
    read_header();
    while (lines_.next())
      if (is_old() || !lines_.line().starts_with('&')) expand_epoch();  // & begins a comment from version 3 on
    return std::move(out_);
  }

 private:
  [[nodiscard]] bool is_old() const { return types_.version() == 2; }
  [[nodiscard]] std::size_t flag_column() const { return is_old() ? 28 : 31; }  ///< from 0
  [[nodiscard]] std::size_t list_column() const { return is_old() ? 32 : 41; }  ///< of the satellites, from 0

  void put(std::string line) {
    drop_blanks_at_end(line);
    if (out_.size() + line.size() + 1 > files::kLargestText)
      lines_.refuse("a text that expands to more than 512 MiB", "a shorter one");
    out_ += line;
    out_ += '\n';
  }

  void need_line(std::string_view of_what) {
    if (!lines_.next()) lines_.refuse("the end of the file", fmt::format("the next line of {}", of_what));
  }

  void read_header() {
    need_line("the header");
    const std::string_view version = files::trimmed(lines_.columns(1, 20));
    if (label_of(lines_) != kLabel || (version != "1.0" && version != "3.0"))
      lines_.refuse("CRINEX VERS   / TYPE with version 1.0 or 3.0");
    need_line("the header");  // program and date of the compression
    need_line("the header");
    types_ = ObservationTypes(observation_version(lines_));
    if (is_old() != (version == "1.0"))
      lines_.refuse(fmt::format("RINEX version {} in compact RINEX {}", types_.version(), version),
                    "RINEX 2 in 1.0, RINEX 3 or 4 in 3.0");
    put(std::string(lines_.line()));
    while (label_of(lines_) != "END OF HEADER") {
      need_line("the header");
      types_.take(lines_);
      put(std::string(lines_.line()));
    }
    types_.check_complete(lines_);
  }

  void expand_epoch() {
    const std::string_view line = lines_.line();
    const char first = is_old() ? '&' : '>';
    if (line.starts_with(first)) {
      epoch_ = is_old() ? " " + std::string(line.substr(1)) : std::string(line);
      satellites_.clear();
    } else {
      if (epoch_.empty()) lines_.refuse(fmt::format("an epoch that begins with {}", first));
      change_text(epoch_, line);
    }
    constexpr std::size_t kLongestEpoch = 41 + 3 * static_cast<std::size_t>(ObservationReader::kMaxSatellites) + 80;
    if (epoch_.size() > kLongestEpoch)
      lines_.refuse(fmt::format("an epoch of {} characters", epoch_.size()), fmt::format("at most {}", kLongestEpoch));
    const std::string_view number = text_of_epoch(flag_column() + 1, 3);
    const auto count = files::integer_of(number);
    if (!count || *count < 0)
      lines_.refuse(fmt::format("{} for a number of satellites", files::quoted(number)), "an integer");
    const std::string_view flag = text_of_epoch(flag_column(), 1);
    if (!flag.empty() && flag.front() > '1') {
      expand_event(*count);
    } else {
      if (*count > ObservationReader::kMaxSatellites)
        lines_.refuse(fmt::format("{} satellites", *count), fmt::format("0 to {}", ObservationReader::kMaxSatellites));
      expand_observations(static_cast<std::size_t>(*count));
    }
  }

  [[nodiscard]] std::string_view text_of_epoch(std::size_t column, std::size_t size) const {
    return column < epoch_.size() ? std::string_view(epoch_).substr(column, size) : std::string_view{};
  }

  /// Lines of an event follow as they are; the epoch behind them is a complete one.
  void expand_event(int count) {
    put(epoch_);
    for (int k = 0; k < count; ++k) {
      need_line("an event");
      types_.take(lines_);
      put(std::string(lines_.line()));
    }
    types_.check_complete(lines_);
    epoch_.clear();
    satellites_.clear();
    clock_.close();
  }

  void expand_observations(std::size_t count) {
    need_line("the epoch's clock");
    const std::string clock = expand_clock();
    std::vector<std::string> names;
    for (std::size_t k = 0; k < count; ++k) {
      std::string name(text_of_epoch(list_column() + 3 * k, 3));
      if (name.size() < 3 || files::trimmed(name).empty())
        lines_.refuse(fmt::format("{} satellites and no name of number {}", count, k + 1), "a name of each");
      names.push_back(std::move(name));
    }
    put_epoch(names, clock);
    std::map<std::string, SatelliteArcs> now;
    for (const std::string& name : names) {
      need_line(fmt::format("satellite {}", name));
      const std::size_t types = types_.of(name.front()).size();
      SatelliteArcs& arcs = now[name];
      const auto before = satellites_.find(name);
      if (before != satellites_.end()) arcs = std::move(before->second);
      arcs.arcs.resize(types);
      arcs.flags.resize(2 * types, ' ');
      expand_satellite(name, arcs);
    }
    satellites_ = std::move(now);
  }

  std::string expand_clock() {
    const std::string_view text = files::trimmed(lines_.line());
    if (text.empty()) {
      clock_.close();
      return {};
    }
    advance(clock_, text);
    return is_old() ? fixed(clock_.value(), 9, 12) : fixed(clock_.value(), 12, 15);
  }

  void put_epoch(const std::vector<std::string>& names, const std::string& clock) {
    std::string line = epoch_.substr(0, list_column());
    line.resize(list_column(), ' ');
    if (!is_old()) {
      put(line + clock);
      return;
    }
    constexpr std::size_t kPerLine = 12, kClockColumn = 68;
    for (std::size_t k = 0; k == 0 || k < names.size(); k += kPerLine) {
      if (k > 0) line.assign(list_column(), ' ');
      for (std::size_t n = k; n < names.size() && n < k + kPerLine; ++n) line += names[n];
      if (k == 0 && !clock.empty()) {
        line.resize(kClockColumn, ' ');
        line += clock;
      }
      put(line);
    }
  }

  /// Opens an arc ("3&value") or adds a difference.
  void advance(DifferenceArc& arc, std::string_view text) {
    const auto integer = [&](std::string_view digits) {
      std::int64_t value = 0;
      const bool is_negative = digits.starts_with('-');
      const std::string_view rest = is_negative ? digits.substr(1) : digits;
      constexpr std::size_t kMostDigits = 16;
      if (rest.empty() || rest.size() > kMostDigits || rest.find_first_not_of("0123456789") != std::string_view::npos)
        lines_.refuse(fmt::format("the field {}", files::quoted(text)), "an integer, or its order, & and an integer");
      for (const char digit : rest) value = 10 * value + (digit - '0');
      return is_negative ? -value : value;
    };
    if (text.size() > 1 && text[1] == '&') {
      if (text[0] < '0' || text[0] > '9')
        lines_.refuse(fmt::format("the field {}", files::quoted(text)), "an order from 0 to 9");
      arc.open(static_cast<std::size_t>(text[0] - '0'), integer(text.substr(2)));
      return;
    }
    if (!arc.is_open())
      lines_.refuse(fmt::format("the difference {} without a first value", files::quoted(text)), "a field as 3&value");
    if (!arc.add(integer(text)))
      lines_.refuse("differences whose sum exceeds 64 bits", "the differences of observations");
  }

  /// An integer as Fortran prints it with `decimals` in a field.
  std::string fixed(std::int64_t value, std::size_t decimals, std::size_t width) const {
    std::string digits = std::to_string(value < 0 ? -value : value);
    if (digits.size() < decimals) digits.insert(0, decimals - digits.size(), '0');
    digits.insert(digits.size() - decimals, 1, '.');
    if (value < 0) digits.insert(0, 1, '-');
    if (digits.size() > width)
      lines_.refuse(fmt::format("the value {}", digits), fmt::format("at most {} characters", width));
    return std::string(width - digits.size(), ' ') + digits;
  }

  void expand_satellite(const std::string& name, SatelliteArcs& satellite) {
    std::string_view rest = lines_.line();
    for (DifferenceArc& arc : satellite.arcs) {
      const std::size_t end = std::min(rest.find(' '), rest.size());
      const std::string_view field = rest.substr(0, end);
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (field.empty()) {
        arc.close();
      } else {
        advance(arc, field);
      }
    }
    if (rest.size() > satellite.flags.size())
      lines_.refuse(fmt::format("{} flags", rest.size()), fmt::format("at most {}", satellite.flags.size()));
    change_text(satellite.flags, rest);
    std::string line = is_old() ? "" : name;
    constexpr std::size_t kPerLine = 5, kNumber = 14, kDecimals = 3;
    for (std::size_t k = 0; k < satellite.arcs.size(); ++k) {
      if (is_old() && k > 0 && k % kPerLine == 0) {
        put(std::move(line));
        line.clear();
      }
      const DifferenceArc& arc = satellite.arcs[k];
      line += arc.is_open() ? fixed(arc.value(), kDecimals, kNumber) : std::string(kNumber, ' ');
      line += arc.is_open() ? satellite.flags.substr(2 * k, 2) : std::string("  ");
    }
    put(std::move(line));
  }

  files::TextLines lines_;
  ObservationTypes types_;
  std::string out_;
  std::string epoch_;  ///< text of the epoch before, and of an event: empty
  DifferenceArc clock_;
  std::map<std::string, SatelliteArcs> satellites_;
};

}  // namespace

bool is_compact_rinex(std::string_view text) {
  const std::string_view first = text.substr(0, text.find('\n'));
  return first.size() >= 60 + kLabel.size() && first.substr(60).starts_with(kLabel);
}

std::string expand_compact_rinex(std::string_view text, const std::string& file) {
  return Expander(text, file).expand();
}

}  // namespace vbar::observation_files
