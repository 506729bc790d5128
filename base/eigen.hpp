// Eigen, with the settings that the libraries were built with.
//
// Eigen's vectors and matrices cross the libraries' boundary by value: what one side allocates the
// other frees, and how depends on EIGEN_MALLOC_ALREADY_ALIGNED, which follows from the compiler's
// -march unless it is set, as EIGEN_MAX_ALIGN_BYTES does. wheeltap::base sets both for whoever
// links it; code that is compiled without them is refused here, rather than left to crash in
// free().
//
// EIGEN_NO_CPUID: Eigen cuts sums of products to the sizes of the caches, which it asks of the
// processor; their rounding, and with it every draw of a chain, would depend on the machine. With
// it the sizes are the same everywhere.
#pragma once

#include "base/eigen_products.hpp"

#if !defined(EIGEN_NO_CPUID)
#error \
    "wheeltap is built with EIGEN_NO_CPUID: link wheeltap::base, or define it, for every file that uses Eigen"
#endif
static_assert(
    EIGEN_MAX_ALIGN_BYTES == 16 && EIGEN_MALLOC_ALREADY_ALIGNED == 1,
    "wheeltap is built with EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MALLOC_ALREADY_ALIGNED=1: link "
    "wheeltap::base, or define them so, for every file that uses Eigen");
