#include "fsw/vision/target_tracking/track_hypothesis.h"

namespace vbar::fsw::target_tracking {

bool share_recent(const Hypothesis& a, const Hypothesis& b, std::size_t images) {
  int common = 0;
  for (std::size_t k = 0; k < images && k < kHistory; ++k) {
    if (a.history[k] != b.history[k]) return false;
    if (a.history[k] >= 0) ++common;
  }
  return common >= 2;
}

bool agree(const Hypothesis& a, const Hypothesis& b) {
  int common = 0;
  for (std::size_t k = 0; k < kHistory; ++k) {
    if (a.history[k] < 0 || b.history[k] < 0) continue;
    if (a.history[k] != b.history[k]) return false;
    ++common;
  }
  return common >= 2;
}

int objects_of_its_own(const Hypothesis& a, const Hypothesis& b) {
  int own = 0;
  for (std::size_t k = 0; k < kHistory; ++k) {
    if (a.history[k] >= 0 && a.history[k] != b.history[k]) ++own;
  }
  return own;
}

int hits_of(std::uint32_t bits, int count) {
  int hits = 0;
  for (int k = 0; k < count && k < 32; ++k) hits += static_cast<int>((bits >> static_cast<unsigned>(k)) & 1U);
  return hits;
}

}  // namespace vbar::fsw::target_tracking
