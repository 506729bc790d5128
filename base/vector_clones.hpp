// Selection of the SIMD width of an expensive loop at run time, so that a portable build is fast.
#pragma once

// Sanitizer builds do not use target clones, because GCC selects the clones at load time, before
// the run-time library of the sanitizer is ready. clang-format off
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__AVX2__)
#define WHEELTAP_VECTOR_CLONES \
  __attribute__((target_clones("default", "avx2", "arch=skylake-avx512")))
#else
#define WHEELTAP_VECTOR_CLONES
#endif
// clang-format on
