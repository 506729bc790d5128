// Eigen, with the settings of the library build.
//
// Functions of the library take and return Eigen's vectors and matrices by value: one side of the
// library boundary allocates the memory, and the other side frees it. The method of deallocation
// depends on EIGEN_MALLOC_ALREADY_ALIGNED. Without explicit settings, this macro and
// EIGEN_MAX_ALIGN_BYTES follow from the compiler's option -march. The target wheeltap::base sets
// both macros. Without these settings, compilation stops here, because the program could crash in
// free().
//
// EIGEN_NO_CPUID: by default, Eigen splits sums of products by cache sizes read from the processor.
// Rounding errors, and therefore every draw of a Markov chain, would depend on the machine. With
// EIGEN_NO_CPUID, Eigen assumes the same cache sizes on every machine.
#pragma once

#include "base/eigen_products.hpp"

#if !defined(EIGEN_NO_CPUID)
#error \
    "wheeltap is built with EIGEN_NO_CPUID: for every file that uses Eigen, link wheeltap::base or define this macro"
#endif
static_assert(
    EIGEN_MAX_ALIGN_BYTES == 16 && EIGEN_MALLOC_ALREADY_ALIGNED == 1,
    "wheeltap is built with EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MALLOC_ALREADY_ALIGNED=1: link "
    "wheeltap::base, or define these macros, for every file that uses Eigen");
