#pragma once
// A thread for work that must stay on one thread (an OpenGL context), in the order of the requests.

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "fsw/core/gps_time.h"
#include "host_sim/engine/clock.h"
#include "host_sim/twins/camera/exposure.h"
#include "host_sim/twins/camera/image_maker.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins::camera {

class Worker {
 public:
  Worker();
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Returns when the job at hand is finished; the futures of jobs not started are broken (std::future_error), as are
  /// those of jobs to come.
  void stop();

  /// Runs `job` on the worker's thread, after all jobs before it; its exceptions come out of the future.
  template <class Job>
  std::future<std::invoke_result_t<Job>> run(Job job) {
    // A std::function must be copyable, which a task is not.
    auto task = std::make_shared<std::packaged_task<std::invoke_result_t<Job>()>>(std::move(job));
    auto result = task->get_future();
    enqueue([task = std::move(task)] { (*task)(); });
    return result;
  }

 private:
  void enqueue(std::function<void()> job);
  void work();

  std::mutex mutex_;
  std::condition_variable something_to_do_;
  std::deque<std::function<void()>> jobs_;
  bool stop_ = false;
  std::thread thread_;  // last: it uses all the others
};

// A camera as a packet source: an image every period, taken on a thread of its own while the simulation goes on,
// because it leaves the camera only when it has been read out. An ImageTaker produces it (image_maker.h).

class CameraSensor final : public PacketSource {
 public:
  struct Settings {
    ImageMaker::Settings image;
    CameraMount mount;
    engine::Cadence images{fsw::GpsTime{}, fsw::duration_of_seconds(60)};  ///< middles of the exposures
    std::optional<fsw::GpsTime> until = std::nullopt;                      ///< no image after it
    fsw::Duration readout;  ///< >= 0: from the middle of an exposure until its packets leave
    /// Exposure of the first images, if commands may change it; without a value it is always that of the settings.
    std::optional<double> first_exposure_s = std::nullopt;
    bool sends_packets = true;                                    ///< false: the images are in the log only
    std::chrono::milliseconds timeout = std::chrono::minutes(5);  ///< on the wall, for one image
  };

  /// Throws std::invalid_argument if a recipe cannot hold the models of the mount (logged_image.h).
  CameraSensor(const Settings& settings, std::unique_ptr<ImageTaker> taker);
  /// Makes the digital camera. `renderer` is called on the sensor's own thread.
  CameraSensor(const Settings& settings, Renderer renderer)
      : CameraSensor(settings, std::make_unique<ImageMaker>(settings.image, std::move(renderer))) {}

  void start(fsw::GpsTime first_epoch) override { taker_->start(first_epoch); }
  /// Returns when no image is being taken: a testbed may then close its devices.
  void stop(StopReason reason) override {
    taker_->stop(reason);
    worker_.stop();
  }

  [[nodiscard]] std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override;

  /// Begins the image, whose packets are `pending`. If the taker is reproducible, `recipe` regenerates them. If it is
  /// not, they come with a recording, and `recipe` is the exposure of which the digital twin makes an image too.
  /// kFailed if the truth lacks the spacecraft or its attitude.
  Measurement measure(const TruthSnapshot& truth) override;

  /// Applies a command of the exposure of its images.
  void command(const fsw::packets::PacketView& packet, fsw::GpsTime effective) override;

  [[nodiscard]] bool truth_is_compared() const override { return settings_.sends_packets; }
  [[nodiscard]] std::chrono::milliseconds wait_limit() const override { return settings_.timeout; }

  /// Returns the number of "images" taken, the "packing_s" of the wall clock spent on their packets, and the figures of
  /// the taker. A taker that is not reproducible adds the "recording_s" spent on recordings, and "recorded_bytes".
  [[nodiscard]] std::vector<Note> statistics() const override;

 private:
  struct CommandedExposure {
    fsw::GpsTime from;
    double duration_s = 0.0;
  };
  [[nodiscard]] std::optional<double> duration_at(fsw::GpsTime time);
  Completion take(const Exposure& exposure);
  LoggedImage record(const Exposure& exposure, std::span<const std::uint16_t> dn);

  Settings settings_;
  std::unique_ptr<ImageTaker> taker_;
  std::vector<CommandedExposure> commanded_;  ///< in order of time, that in force first
  std::atomic<double> packing_s_{0.0};
  std::atomic<double> recording_s_{0.0};
  std::atomic<std::int64_t> images_{0}, recorded_bytes_{0};
  Worker worker_;  // last: its thread uses all the others
};

}  // namespace vbar::twins::camera
