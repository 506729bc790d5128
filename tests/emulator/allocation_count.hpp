// Counts heap allocations, for tests that a hot path makes none.
#pragma once

namespace wheeltap::test {
/// Calls of operator new by this thread so far.
[[nodiscard]] long allocations();
}  // namespace wheeltap::test
