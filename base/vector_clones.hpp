// Run-time dispatch of a hot loop to the processor's vector width, so that a portable build is
// fast.
#pragma once

// GCC resolves the clones at load time, before a sanitizer's run-time is ready: no clones then.
// clang-format off
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__AVX2__)
#define WHEELTAP_VECTOR_CLONES __attribute__((target_clones("default", "avx2", "arch=skylake-avx512")))
#else
#define WHEELTAP_VECTOR_CLONES
#endif
// clang-format on
