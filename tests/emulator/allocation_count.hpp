// Counts heap allocations, for tests of code that must not allocate.
#pragma once

namespace wheeltap::test {
/// Calls of operator new by this thread so far.
[[nodiscard]] long allocations();
}  // namespace wheeltap::test
