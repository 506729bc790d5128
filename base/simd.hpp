// Loops compiled once for each SIMD width and selected at run time.
// Each loop has its own implementation file. The build compiles this file once for each instruction
// set; each compilation produces a table of functions. The implementation files use only plain
// pointers and no library templates: the linker might select a template instance with AVX-512
// instructions for all processors. `runnable` returns the tables that this processor can run. All
// versions of a loop are compiled without fused multiply-add, so their results are bitwise equal.
// The tests run each version of a loop.
#pragma once

#include <cstdlib>
#include <string_view>
#include <vector>

namespace wheeltap::base {

/// The vector instructions to use; `automatic` selects the widest vector instructions that the
/// processor has.
enum class Instructions { automatic, baseline, avx2, avx512 };

/// The environment variable that names the widest instructions that `automatic` may choose:
/// "baseline", "avx2" or "avx512".
inline constexpr const char* kInstructionsVariable = "WHEELTAP_SIMD";

/// The widest instructions that `automatic` may choose.
[[nodiscard]] inline Instructions widest_allowed() {
  static const Instructions widest = [] {
    const char* chosen = std::getenv(kInstructionsVariable);
    const std::string_view name = chosen == nullptr ? "" : chosen;
    return name == "baseline" ? Instructions::baseline
           : name == "avx2"   ? Instructions::avx2
                              : Instructions::avx512;
  }();
  return widest;
}

/// True if this processor has all instructions that a compilation for `instructions` may use. The
/// compiler flag for avx2 is -mavx2; the flags for avx512 are -mavx512f -mavx512dq -mavx512vl.
[[nodiscard]] inline bool processor_has(Instructions instructions) {
  if (instructions == Instructions::automatic || instructions == Instructions::baseline)
    return true;
#if defined(__x86_64__) && defined(__GNUC__)
  if (instructions == Instructions::avx2) return __builtin_cpu_supports("avx2") != 0;
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
         __builtin_cpu_supports("avx512vl") != 0;
#else
  return false;
#endif
}

/// The function tables of one set of loops. A pointer is null if the build has no table for these
/// instructions.
template <class Table>
struct Compiled {
  const Table* baseline;
  const Table* avx2 = nullptr;
  const Table* avx512 = nullptr;
};

/// Returns the function tables that this processor can run, by ascending SIMD width. If `wanted` is
/// not `automatic`, returns only the table of `wanted`. The list is empty if `wanted` is not
/// available.
template <class Table>
[[nodiscard]] std::vector<const Table*> runnable(const Compiled<Table>& compiled,
                                                 Instructions wanted = Instructions::automatic) {
  std::vector<const Table*> tables;
  const auto add = [&](Instructions offered, const Table* table) {
    const bool chosen =
        wanted == Instructions::automatic ? offered <= widest_allowed() : wanted == offered;
    if (chosen && table != nullptr && processor_has(offered)) tables.push_back(table);
  };
  add(Instructions::baseline, compiled.baseline);
  add(Instructions::avx2, compiled.avx2);
  add(Instructions::avx512, compiled.avx512);
  return tables;
}

}  // namespace wheeltap::base
