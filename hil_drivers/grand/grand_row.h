#pragma once
// Record of a second of the testbed (grand.csv).

#include <cstdint>
#include <optional>
#include <string>

#include "host_sim/report/run_columns.h"

namespace vbar::grand {

/// State of one receiver in that second.
struct ReceiverSecond {
  std::int64_t bytes = 0;
  int time_status = 0;              ///< status of its last epoch, as in the header of its logs
  int tracked_signals = 0;          ///< number in its last epoch
  bool is_lost = false;             ///< not connected, or silent
  std::optional<double> latency_s;  ///< from an epoch to its last byte at the host, of an epoch that arrived
};

struct GrandRow {
  double time_s = 0.0;                                            ///< since the mission's epoch
  std::optional<double> edge_s;                                   ///< the last edge, since the generator's start
  std::optional<double> host_minus_edge_ms;                       ///< predicted by the host's clock minus measured
  std::optional<double> sample_lead_min_ms, sample_lead_mean_ms;  ///< a sample's own time before its sending
  std::int64_t samples = 0, samples_late = 0, samples_missing = 0;
  std::string generator_state;
  std::optional<double> extrapolation;  ///< 0 deterministic, 1 not deterministic, 2 snap; the worst of the vehicles
  ReceiverSecond servicer, target;
};

template <report::columns::RowOf<GrandRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  using report::ColumnName;
  visit(ColumnName{"time_s", "s, since the epoch of the mission"}, row.time_s);
  visit(ColumnName{"edge_s", "last edge of the 1PPS, since the generator's start"}, row.edge_s);
  visit(ColumnName{"host_minus_edge_ms", "edge as predicted by the host's clock minus measured"},
        row.host_minus_edge_ms);
  visit(ColumnName{"sample_lead_min_ms", "time of a sample minus that of its sending, least"}, row.sample_lead_min_ms);
  visit(ColumnName{"sample_lead_mean_ms", "time of a sample minus that of its sending, mean"}, row.sample_lead_mean_ms);
  visit(ColumnName{"samples", "sent in this second"}, row.samples);
  visit(ColumnName{"samples_late", "of these, sent after their time"}, row.samples_late);
  visit(ColumnName{"samples_missing", "of the second, not sent"}, row.samples_missing);
  visit(ColumnName{"generator_state", "as the generator reports it"}, row.generator_state);
  visit(ColumnName{"extrapolation", "0 deterministic, 1 not deterministic, 2 snap; the worst of the vehicles"},
        row.extrapolation);
  const auto receiver = [&](std::string_view spacecraft, auto& of) {
    visit(ColumnName{spacecraft, "of the receiver in this second", "bytes"}, of.bytes);
    visit(ColumnName{spacecraft, "of its last epoch, as in the header of its logs", "time_status"}, of.time_status);
    visit(ColumnName{spacecraft, "in its last epoch", "tracked_signals"}, of.tracked_signals);
    visit(ColumnName{spacecraft, "1: not connected, or silent", "lost"}, of.is_lost);
    visit(ColumnName{spacecraft, "from an epoch to its last byte at the host", "latency_s"}, of.latency_s);
  };
  receiver("servicer", row.servicer);
  receiver("target", row.target);
}

}  // namespace vbar::grand
