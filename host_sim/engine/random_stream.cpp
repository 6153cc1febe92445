#include "host_sim/engine/random_stream.h"

#include <Random123/philox.h>

#include "host_sim/engine/distributions.h"

namespace vbar::engine {

RandomStream::RandomStream(std::uint64_t seed, std::string_view name) : key_{seed, fnv1a_64(name)} {}

std::array<std::uint64_t, 4> RandomStream::block(Domain domain, std::uint64_t index) const {
  const r123::Philox4x64 philox;
  const r123::Philox4x64::ctr_type counter{{index, static_cast<std::uint64_t>(domain), 0, 0}};
  const r123::Philox4x64::key_type key{{key_[0], key_[1]}};
  const r123::Philox4x64::ctr_type out = philox(counter, key);
  return {out[0], out[1], out[2], out[3]};
}

std::uint64_t RandomStream::bits() {
  const std::uint64_t index = position_ / 4;
  if (index != cached_index_) {
    cached_block_ = block(Domain::kSequence, index);
    cached_index_ = index;
  }
  return cached_block_[position_++ % 4];
}

double RandomStream::uniform() {
  return open_unit_interval(bits());
}

double RandomStream::uniform(double low, double high) {
  return low + (high - low) * uniform();
}

double RandomStream::normal() {
  return normal_quantile(uniform());
}

double RandomStream::exponential() {
  return exponential_upper_quantile(uniform());
}

std::array<double, 4> RandomStream::uniforms_of(std::uint64_t index) const {
  const auto words = block(Domain::kNumbered, index);
  return {open_unit_interval(words[0]), open_unit_interval(words[1]), open_unit_interval(words[2]),
          open_unit_interval(words[3])};
}

}  // namespace vbar::engine
