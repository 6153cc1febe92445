#include "hil_drivers/tron/bench/lights/source_arbiter.h"

#include <algorithm>

namespace vbar::tron::bench {
namespace {

/// E1.31 6.7.2: a packet is out of sequence if it is up to 19 behind the last one, or the last one again.
bool is_out_of_sequence(std::uint8_t sequence, std::uint8_t last) {
  const auto step = static_cast<std::int8_t>(static_cast<std::uint8_t>(sequence - last));
  return step <= 0 && step > -20;
}

}  // namespace

bool SourceArbiter::is_for_us(const sacn::DataPacket& packet) {
  if (packet.universe != universe_) {
    ++counts_.of_other_universes;
    return false;
  }
  if (packet.is_preview) {
    ++counts_.previews;
    return false;
  }
  if (packet.start_code != 0 && !packet.is_terminated) {
    ++counts_.of_other_start_codes;
    return false;
  }
  return true;
}

void SourceArbiter::accept(const sacn::DataPacket& packet, double bench_s) {
  if (!is_for_us(packet)) return;
  auto source = std::ranges::find(sources_, packet.cid, &Source::cid);
  if (source != sources_.end() && is_out_of_sequence(packet.sequence, source->sequence)) {
    ++counts_.out_of_sequence;
    return;
  }
  if (packet.is_terminated) {
    if (source == sources_.end()) return;  // further packets of a source that has ended
    ++counts_.terminations;
    sources_.erase(source);
    return;
  }
  if (source == sources_.end()) {
    if (sources_.size() == kMaxSources) {
      ++counts_.refused_sources;
      return;
    }
    source = sources_.insert(source, Source{packet.cid});
  }
  ++counts_.accepted;
  source->priority = packet.priority;
  source->sequence = packet.sequence;
  source->heard_s = bench_s;
  source->slots = packet.slots;
}

void SourceArbiter::advance(double bench_s) {
  counts_.losses +=
      std::erase_if(sources_, [&](const Source& source) { return bench_s - source.heard_s > kLossSeconds; });
}

std::span<const std::uint8_t> SourceArbiter::slots() const {
  const auto controlling = std::ranges::max_element(sources_, {}, &Source::priority);  // the first of several
  if (controlling == sources_.end()) return {};
  return controlling->slots;
}

}  // namespace vbar::tron::bench
