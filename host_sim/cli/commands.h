#pragma once
// The commands of `vbar`. Each returns the program's exit code (exit_codes.h).

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace vbar::app {

struct RunOptions {
  std::filesystem::path mission;
  std::filesystem::path out;           ///< empty: report::default_run_folder
  std::vector<std::string> overrides;  ///< "path=value"
  bool force = false;                  ///< a run that `out` holds is replaced
  bool check = false;                  ///< only the mission file is read
  bool quiet = false;                  ///< nothing is printed but errors
  bool view = false;                   ///< vbar_watch serves the page of the run while it goes on
  bool view_control = false;           ///< and may change the pace of the run
};
int run_command(const RunOptions& options);

struct PropagateOptions {
  std::filesystem::path mission;
  std::filesystem::path out;  ///< empty: runs/<mission>-truth
  bool oem = false;           ///< CCSDS orbit ephemeris messages too
  bool quiet = false;
  std::vector<std::string> overrides;  ///< "path=value"
};
int propagate_command(const PropagateOptions& options);

struct ReplayOptions {
  std::filesystem::path run_folder;
  std::vector<std::string> overrides;  ///< settings of the flight computer only
  bool trust = false;                  ///< libraries, devices and addresses that the folder names may be used
  bool quiet = false;
  std::filesystem::path save;  ///< file of a snapshot to write; empty: none
  double save_at_h = 0.0;      ///< after the last step until then, hours of the mission
  std::filesystem::path from;  ///< snapshot to continue from; empty: from the start
};
int replay_command(const ReplayOptions& options);

struct ResumeOptions {
  std::filesystem::path run_folder;
  std::optional<double> branch_at_h;   ///< hours of the mission; none: the run itself is continued
  std::vector<std::string> overrides;  ///< settings of the branch, "path=value"
  std::filesystem::path out;           ///< folder of the branch; empty: report::default_run_folder
  bool trust = false;                  ///< libraries, devices and addresses that the folder names may be used
  bool quiet = false;
};
int resume_command(const ResumeOptions& options);

struct ReportOptions {
  std::vector<std::filesystem::path> run_folders;
  std::filesystem::path out;       ///< file of the comparison; empty: beside the first run
  bool fail_if_different = false;  ///< kDifferent if a run's outputs are not those of the first
};
/// Writes the report.html of one run, or a comparison of several.
int report_command(const ReportOptions& options);

struct ViewOptions {
  std::vector<std::filesystem::path> run_folders;
  std::filesystem::path out;  ///< file of the page; empty: in the run folder, or beside the first of several
};
/// Writes the page on which a run, or several over each other, can be looked at.
int view_command(const ViewOptions& options);

struct CheckOptions {
  std::vector<std::filesystem::path> run_folders;
  std::filesystem::path limits;  ///< mission file whose limits hold in place of those of the runs' own missions
  std::filesystem::path junit;   ///< file of the results as JUnit XML; empty: none
  bool numbers = false;          ///< only prints the numbers that a limit can name
};
/// kLimitMissed if a run is incomplete or misses one of its limits.
int check_command(const CheckOptions& options);

struct NewArticleOptions {
  std::filesystem::path folder;  ///< created; its name is that of the article
  std::string language = "c";    ///< c | c++
};
/// A project of the user's own flight software, which builds a shared library or an image for the Zynq-7000 with the
/// installed package of vbar.
int new_article_command(const NewArticleOptions& options);

/// Keys whose path or meaning contains `word` (empty: all), or all as a page in Markdown.
int keys_command(const std::string& word, bool markdown);
int columns_command(const std::string& word, bool markdown);

/// A word that runs print, given as one or several arguments; none: all of them by name; or all as a page in Markdown.
int explain_command(const std::vector<std::string>& word, bool markdown);

/// The missions of a folder, or one by its name or file. Empty: those of mission::missions_directory().
int missions_command(const std::filesystem::path& folder_or_mission);

/// Adds `vbar fit`, an orbit fitted to the positions of a file with the forces of a mission; when it was chosen,
/// `exit_code` is its exit code.
void add_fit_command(CLI::App& program, int& exit_code);

struct StarsOptions {
  std::vector<std::filesystem::path> images;
  double focal_length_px = 0.0;
  double search_percent = 0.0;             ///< focal lengths about the given one that are tried
  std::vector<double> principal_point_px;  ///< x, y; empty: middle of the image
  std::vector<double> distortion;          ///< k1, k2, p1, p2, k3; empty: none
  double centroid_floor_px = 0.3;
  double detection_sigmas = 5.0;
  std::string utc;              ///< of the images, for aberration; empty: left out
  bool calibrate = false;       ///< the lens is fitted to the stars of all images
  std::filesystem::path table;  ///< CSV of the stars; empty: none
};

/// Attitude of a camera by its images of stars, and its lens. kFailed if an image is not identified.
int stars_command(const StarsOptions& options);

}  // namespace vbar::app
