#pragma once
// What a broken precondition of Eigen does, included before everything else: a trap, on every target. A board's fault
// handler reports it; it needs no library and never vanishes from a release.

#define eigen_assert(x) (__builtin_expect(static_cast<bool>(x), 1) ? static_cast<void>(0) : __builtin_trap())
