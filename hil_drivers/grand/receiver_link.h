#pragma once
// Link to one receiver during a run: its port, the bursts of its epochs with the attitude at each, its losses and its
// record.

#include <atomic>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "hil_drivers/grand/bursts.h"
#include "hil_drivers/grand/generators/generator.h"
#include "hil_drivers/grand/grand_row.h"
#include "hil_drivers/grand/raw_record.h"
#include "hil_drivers/grand/receiver_port/receiver_port.h"
#include "hil_drivers/grand/tag_check.h"
#include "hil_drivers/grand/turns.h"
#include "hil_drivers/testbed.h"
#include "host_sim/twins/gnss/receiver_bytes.h"

namespace vbar::grand {

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
