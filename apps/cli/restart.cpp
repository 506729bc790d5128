#include "apps/cli/restart.hpp"

#include <unistd.h>

#include <cstdlib>

#include "base/simd.hpp"

namespace wheeltap::apps {

void restart_with(const std::string& instructions, char** argv) {
  const char* chosen = std::getenv(base::kInstructionsVariable);
  if (chosen != nullptr && instructions == chosen) return;
  const bool baseline = instructions == "baseline";
  const std::string without =
      baseline ? "-AVX2,-FMA,-FMA4,-AVX512F,-AVX512VL,-AVX512DQ" : "-AVX512F,-AVX512VL,-AVX512DQ";
  setenv(base::kInstructionsVariable, instructions.c_str(), 1);
  if (instructions != "avx512") {
    setenv("GLIBC_TUNABLES", ("glibc.cpu.hwcaps=" + without).c_str(), 1);
    setenv("OPENBLAS_CORETYPE", baseline ? "NEHALEM" : "HASWELL", 1);
  }
  execv("/proc/self/exe", argv);
}

}  // namespace wheeltap::apps
