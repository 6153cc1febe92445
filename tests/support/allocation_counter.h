#pragma once
// Counts what a program asks of the heap, so that a test can prove flight code asks for nothing. Link
// allocation_counter.cpp into the test's program: it replaces operator new and, where no sanitizer has taken its place,
// malloc.

#include <cstddef>

namespace vbar::test {

/// Allocations of this thread since the program began.
std::size_t allocation_count();

}  // namespace vbar::test
