#pragma once
// A violated precondition of Eigen causes a trap on every target (included before everything else). The fault handler
// of a board reports it; it needs no library and is never removed from a release.

#define eigen_assert(x) (__builtin_expect(static_cast<bool>(x), 1) ? static_cast<void>(0) : __builtin_trap())
