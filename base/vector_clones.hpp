// Run-time selection of a hot loop's vector width, for fast portable builds.
#pragma once

// Not with sanitizers: GCC resolves the clones at load time, before their run-time library is
// ready.
// clang-format off
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__AVX2__)
#define WHEELTAP_VECTOR_CLONES __attribute__((target_clones("default", "avx2", "arch=skylake-avx512")))
#else
#define WHEELTAP_VECTOR_CLONES
#endif
// clang-format on
