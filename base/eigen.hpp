// Eigen, with the alignment that the libraries were built with.
//
// Eigen's vectors and matrices cross the libraries' boundary by value: what one side allocates the
// other frees, and how depends on EIGEN_MAX_ALIGN_BYTES, which follows from the compiler's -march
// unless it is set. wheeltap::base sets it for whoever links it; code that is compiled without it
// is refused here, rather than left to crash in free().
#pragma once

#include <Eigen/Core>

static_assert(
    EIGEN_MAX_ALIGN_BYTES == 16,
    "wheeltap is built with EIGEN_MAX_ALIGN_BYTES=16: link wheeltap::base, or define it so, "
    "for every file that uses Eigen");
