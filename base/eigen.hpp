// Eigen, with the alignment that the libraries were built with.
//
// Eigen's vectors and matrices cross the libraries' boundary by value: what one side allocates the
// other frees, and how depends on EIGEN_MALLOC_ALREADY_ALIGNED, which follows from the compiler's
// -march unless it is set, as EIGEN_MAX_ALIGN_BYTES does. wheeltap::base sets both for whoever
// links it; code that is compiled without them is refused here, rather than left to crash in
// free().
#pragma once

#include <Eigen/Core>

static_assert(
    EIGEN_MAX_ALIGN_BYTES == 16 && EIGEN_MALLOC_ALREADY_ALIGNED == 1,
    "wheeltap is built with EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MALLOC_ALREADY_ALIGNED=1: link "
    "wheeltap::base, or define them so, for every file that uses Eigen");
