#pragma once
// Bytes of one receiver as they came, kept in memory until there is a run folder, then in a file of the folder. Public
// tools read such files (RTKLIB: convbin -r nov).

#include <atomic>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <mutex>
#include <optional>
#include <semaphore>
#include <span>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "hil_drivers/grand/bursts.h"
#include "hil_drivers/grand/generators/generator.h"
#include "hil_drivers/grand/grand_row.h"
#include "hil_drivers/grand/receiver_port.h"
#include "host_sim/io/byte_channel.h"
#include "host_sim/sensors/testbed.h"
#include "host_sim/twins/gnss/receiver_bytes.h"

namespace vbar::grand {

class RawRecord {
 public:
  /// Adds bytes, from any thread. Throws std::runtime_error if the file cannot be extended.
  void add(std::span<const std::uint8_t> bytes);
  /// Writes all bytes, earlier and later ones, to the file. Throws std::runtime_error that names it.
  void keep_in(const std::filesystem::path& file);
  void flush();

 private:
  void write(std::span<const std::uint8_t> bytes);

  std::mutex mutex_;
  std::vector<std::uint8_t> early_;
  std::filesystem::path path_;
  std::ofstream file_;
};

// Comparison of a receiver's time tags with the time of the run: receivers count weeks modulo 1024 and add a constant
// of their firmware, and a scenario may have been started at another time.

class TagCheck {
 public:
  /// `receiver` begins the messages: "receiver of servicer on /dev/ttyUSB0". `max_latency` is that of the first epoch;
  /// below a second it shows a scenario that is off by one second in either direction.
  TagCheck(std::string receiver, bool accepts_week_shift, fsw::Duration max_latency)
      : receiver_(std::move(receiver)), accepts_week_shift_(accepts_week_shift), max_latency_(max_latency) {}

  /// Checks an epoch whose status is FINE or better, and whose last byte arrived at `arrival`. Throws
  /// std::runtime_error, one sentence, if its time is not the run's.
  void check(fsw::GpsTime tag, fsw::GpsTime arrival);

  /// Number of weeks to be added to the receiver's; 0 before the first tag.
  [[nodiscard]] int weeks() const { return weeks_.value_or(0); }
  [[nodiscard]] bool has_checked() const { return weeks_.has_value(); }

 private:
  std::string receiver_;
  bool accepts_week_shift_;
  fsw::Duration max_latency_;
  std::optional<int> weeks_;
};

// Cooperative second thread: it works only while the first one waits for it. A function that has to wait for simulated
// time is continued at each call. Both together are deterministic, as one thread would be.

class Turns {
 public:
  using Point = io::Clock::time_point;

  Turns() = default;
  ~Turns() { abandon(); }
  Turns(const Turns&) = delete;
  Turns& operator=(const Turns&) = delete;

  /// Starts the work. `work` calls wait() to be continued later; it must return or throw soon after is_abandoned().
  void start(std::function<void()> work) {
    is_done_ = false;
    work_ = std::async(std::launch::async, [this, run = std::move(work)] {
      to_work_.acquire();
      struct End {
        Turns& turns;
        ~End() {
          turns.is_done_ = true;
          turns.to_caller_.release();
        }
      } end{*this};
      run();
    });
  }
  [[nodiscard]] bool is_running() const { return work_.valid(); }

  /// Continues the work at `time`, until it waits or ends. Returns true if it has ended; throws what it has thrown.
  bool go_on(Point time) {
    time_ = time;
    to_work_.release();
    to_caller_.acquire();
    if (!is_done_) return false;
    work_.get();
    return true;
  }

  /// Ends the work.
  void abandon() noexcept {
    is_abandoned_ = true;
    while (work_.valid()) {
      try {
        go_on(time_);
      } catch (...) {
        // The work ends by its own exception.
      }
    }
  }

  // Calls of the work.
  [[nodiscard]] Point now() const { return time_; }
  void wait() {
    to_caller_.release();
    to_work_.acquire();
  }
  [[nodiscard]] bool is_abandoned() const { return is_abandoned_; }

 private:
  std::binary_semaphore to_work_{0}, to_caller_{0};
  std::future<void> work_;
  Point time_{};
  bool is_done_ = false;
  std::atomic<bool> is_abandoned_ = false;
};

// Link to one receiver during a run: its port, the bursts of its epochs with the attitude at each, its losses and its
// record.

struct LinkPlan {
  std::string spacecraft;
  std::string device;
  ReceiverConfiguration configuration;
  fsw::Duration period;   ///< period of its epochs
  fsw::Duration give_up;  ///< duration of a loss after which the run ends
  fsw::Duration max_latency = fsw::nearest_duration(testbeds::ReceiverLine{}.max_latency_s);
  bool week_shift = false;
  bool bytes_bypass_host = false;
  Pace pace = Pace::kLockStep;
  Patience start_patience{};
  Patience reopen_patience{.probe = std::chrono::milliseconds(500), .attempts = 1};
};

/// Figures counted over the run.
struct LinkStatistics {
  std::uint64_t bytes = 0;
  std::uint64_t epochs = 0;
  std::uint64_t losses = 0, reconnects = 0;
  double lost_s = 0.0;
  int week_shift = 0;
  std::vector<double> latencies_s;  ///< latency of every epoch with a fine tag
  fsw::gnss::OemStreamCounters stream{};
};

class ReceiverLink {
 public:
  explicit ReceiverLink(LinkPlan plan);
  ~ReceiverLink();
  ReceiverLink(const ReceiverLink&) = delete;
  ReceiverLink& operator=(const ReceiverLink&) = delete;

  /// Opens the port. Throws std::runtime_error, one sentence.
  void open();
  void keep_in(const std::filesystem::path& folder);
  void close() noexcept;

  /// Returns the output of a sample period; called once in each. `arrival` is the time by which the bytes read have
  /// arrived. Throws std::runtime_error, one sentence, if the run must end: lost for too long, tags of another time, a
  /// receiver that withholds its solution.
  twins::gnss::ReceiverOutput take(const twins::gnss::BodyTruth& truth, fsw::GpsTime arrival);

  /// Returns the figures since the last call of this function.
  [[nodiscard]] ReceiverSecond second();
  [[nodiscard]] LinkStatistics statistics() const;
  /// Returns true if the receiver has named itself an emulation; after close().
  [[nodiscard]] bool is_emulated() const { return port_.is_emulated(); }
  [[nodiscard]] bool is_lost() const { return lost_since_.has_value(); }
  /// Number of bytes in logs that were received whole.
  [[nodiscard]] std::uint64_t message_bytes() const { return cutter_.counters().message_bytes; }
  [[nodiscard]] const std::string& spacecraft() const { return plan_.spacecraft; }

 private:
  struct Sample {
    fsw::GpsTime time;
    Eigen::Quaterniond q_body_eci;
    fsw::Vector3 rate_body;
  };

  void remember(const twins::gnss::BodyTruth& truth);
  [[nodiscard]] std::optional<twins::gnss::EpochAttitude> attitude_at(fsw::GpsTime epoch) const;
  std::vector<std::uint8_t> read(fsw::GpsTime now);
  void lose(fsw::GpsTime now, const std::string& reason);
  void try_to_reopen(fsw::GpsTime now);
  void start_reopening();
  void go_on_reopening(fsw::GpsTime now);
  void reconnected(fsw::GpsTime now);
  twins::gnss::ReceiverOutput deliver(std::vector<Burst> bursts, fsw::GpsTime now, fsw::GpsTime arrival);
  void take_tag(Burst& burst, fsw::GpsTime arrival);
  [[nodiscard]] std::string name() const;

  LinkPlan plan_;
  RawRecord raw_;
  ReceiverPort port_;
  BurstCutter cutter_;
  TagCheck tag_check_;
  std::deque<Sample> attitudes_;
  LinkStatistics statistics_;
  ReceiverSecond second_;
  std::vector<twins::Note> notes_;

  std::optional<fsw::GpsTime> last_heard_;  ///< last whole message: a line at another rate gives bytes too
  std::optional<fsw::GpsTime> last_delivery_;
  std::optional<fsw::GpsTime> lost_since_;
  std::string lost_reason_;
  fsw::GpsTime last_call_, next_attempt_, next_failure_;
  std::future<void> reopening_;  ///< real time: on a thread of its own, beside the run
  Turns turns_;                  ///< lock-step: as simulated time goes on
  std::atomic<bool> is_ending_ = false;
};

}  // namespace vbar::grand
