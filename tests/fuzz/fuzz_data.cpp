// The loaders of data files on arbitrary texts; the first byte chooses the loader. Promise: data, or one exception
// derived from std::exception with a message.

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <system_error>

#include "host_sim/mission/body_file.h"
#include "host_sim/sensors/settings/camera_file.h"
#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/truth/earth/space_weather.h"
#include "host_sim/truth/forces/gravity_coefficients.h"
#include "host_sim/twins/camera/star_sky.h"
#include "host_sim/twins/gnss/ephemeris_file.h"
#include "host_sim/twins/gnss/tracking.h"
#include "tests/fuzz/fuzz_file.h"

namespace {

namespace fs = std::filesystem;
using namespace vbar;

/// A data directory whose file `name` is `file`.
class DataDirectory {
 public:
  DataDirectory(const fs::path& name, const fs::path& file)
      : folder_(fs::temp_directory_path() / ("vbar_fuzz_data_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories((folder_ / name).parent_path());
    fs::create_symlink(file, folder_ / name);
  }
  ~DataDirectory() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  DataDirectory(const DataDirectory&) = delete;
  DataDirectory& operator=(const DataDirectory&) = delete;
  [[nodiscard]] const fs::path& path() const { return folder_; }

 private:
  fs::path folder_;
};

void load(unsigned loader, const fs::path& file) {
  switch (loader) {
    case 0:
      static_cast<void>(truth::load_gravity_coefficients(file, 8));
      break;
    case 1:
      static_cast<void>(truth::EarthOrientationSeries::load(file));
      break;
    case 2:
      static_cast<void>(truth::SpaceWeather::load(file));
      break;
    case 3:
      static_cast<void>(truth::load_nrlmsise00_tables(file));
      break;
    case 4:
      static_cast<void>(twins::gnss::read_ephemeris_file(file));
      break;
    case 5:
      static_cast<void>(
          twins::gnss::AntennaPattern::load(DataDirectory("gps/receiver_antenna_typical_patch.csv", file).path()));
      break;
    case 6:
      static_cast<void>(twins::camera::StarSky::load(file, 1e10));
      break;
    case 7:
      static_cast<void>(sensors::load_camera(file));
      break;
    default:
      static_cast<void>(mission::load_body(file));
      break;
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const fuzz::File file({data + 1, size - 1});
  try {
    load(data[0] % 9U, file.path());
  } catch (const std::exception& error) {
    VBAR_FUZZ_EXPECT(error.what()[0] != '\0');
  }
  return 0;
}
