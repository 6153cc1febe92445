#pragma once
// Cases and shares as text.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/campaign_report/campaign.h"
#include "host_sim/campaign_report/quantity.h"
#include "host_sim/campaign_report/requirement.h"
#include "host_sim/campaign_report/statistics.h"
#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/svg_plot.h"

namespace vbar::campaign_report {

// Histogram and empirical distribution function of a figure, with its limits.

/// Both plots are of at least one value, sorted.
[[nodiscard]] report::Plot histogram(const Quantity& quantity, const std::vector<double>& sorted);
[[nodiscard]] report::Plot distribution_function(const Quantity& quantity, const std::vector<double>& sorted);

/// The steps of an empirical distribution function, at most `max_steps` of them and both ends: (value, share of the
/// values up to it).
[[nodiscard]] std::vector<report::Point> distribution_steps(const std::vector<double>& sorted, std::size_t max_steps);

// Flights of a campaign over each other.

struct Flight {
  std::uint64_t number = 0;                 ///< of its case
  std::vector<report::Point> error, range;  ///< (hours, m): of the estimated relative position; true
};

/// The complete cases of which the folder keeps runs with tables, spread over all where they are more than 40. Throws
/// std::runtime_error for a file that cannot be read.
[[nodiscard]] std::vector<Flight> kept_flights(const std::filesystem::path& folder, const Campaign& campaign);

// The parts of the page, in its order. A section without anything to show has no content.

/// Confidence of all bounds on the page.
inline constexpr double kConfidence = 0.95;

/// Content from which the sections are made.
struct Content {
  const Campaign& campaign;
  std::vector<Quantity> quantities;
  std::string folder_name;  ///< folder of the campaign
  const std::vector<JudgedRequirement>& requirements;
  const std::vector<Flight>& flights;
};

[[nodiscard]] std::string overview(const Content& content);  ///< as HTML
[[nodiscard]] report::Section requirement_section(const Content& content);
[[nodiscard]] report::Section pass_rate_section(const Content& content);
[[nodiscard]] report::Section flight_section(const Content& content);
[[nodiscard]] report::Section distribution_section(const Content& content);
[[nodiscard]] report::Section miss_section(const Content& content);
[[nodiscard]] report::Section consistency_section(const Content& content);
[[nodiscard]] report::Section driver_section(const Content& content);
[[nodiscard]] report::Section worst_section(const Content& content);
[[nodiscard]] report::Section failure_section(const Content& content);
[[nodiscard]] report::Section processor_section(const Content& content);

/// "99.13 %", with more digits where it would be written as 100 % without being it.
[[nodiscard]] std::string percent(double share);

/// "83.16 to 100 %"
[[nodiscard]] std::string bounds_text(const PassRate& rate);

/// "1 case", "2,000 cases"
[[nodiscard]] std::string count_text(std::size_t count, const char* singular, const char* plural);

/// Name of a folder, however its path ends.
[[nodiscard]] std::string name_of_folder(const std::filesystem::path& folder);

/// The command that flies a case again.
[[nodiscard]] std::string rerun_command(const std::string& folder, const Case& one);

/// Shortens keys to what distinguishes them: "servicer.mass_kg", "target.mass_kg", "loss_probability".
[[nodiscard]] std::vector<std::string> short_names(const std::vector<std::string>& keys);

/// "servicer.mass_kg = 153.41 kg; ...": swept and dispersed values, shortened.
[[nodiscard]] std::string inputs_text(const Campaign& campaign, const Case& one);

/// The number of cases that `holds` is true of.
template <class Predicate>
[[nodiscard]] std::size_t count_cases(const Campaign& campaign, const Predicate& holds) {
  std::size_t count = 0;
  for (const Case& one : campaign.cases) count += holds(one) ? 1 : 0;
  return count;
}

// The page of a campaign: one file that opens from disk, without scripts.

/// The page. `folder_name` stands in the commands that fly a case again.
[[nodiscard]] std::string page_of(const Campaign& campaign, const std::string& folder_name,
                                  const std::vector<JudgedRequirement>& requirements,
                                  const std::vector<Flight>& flights = {});

}  // namespace vbar::campaign_report

namespace vbar::campaign {

struct WrittenPage {
  std::filesystem::path page;
  std::vector<campaign_report::JudgedRequirement> requirements;
};

/// Reads campaign.json and results.csv of the folder, of a campaign that has ended or still runs, and writes
/// campaign.html and campaign_results.json. The same two files give the same contents. Throws std::runtime_error that
/// names what is missing or wrong; a page that was there before then still is.
WrittenPage write_page(const std::filesystem::path& folder);

}  // namespace vbar::campaign
