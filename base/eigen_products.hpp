// Matrix products and solutions of triangular systems, compiled once.
//
// Eigen divides C = A B into panels and multiplies them with a kernel (`gebp_kernel`; Goto & van de
// Geijn 2008). The kernel is a template of the scalar types and storage orders. Without this
// header, every source file with a matrix product compiles the kernel; these compilations took a
// third of the build time. With the following declarations, only eigen_products.cpp compiles the
// kernel. The results of products do not change, because the kernel is compiled from the same code
// with the same options.
//
// The names of the templates are those of Eigen 3.4. With another version of Eigen, or an
// instruction set other than that of the library build, this header declares nothing, and each
// source file compiles its own kernel.
#pragma once

#include <Eigen/Core>
#include <complex>

#if EIGEN_WORLD_VERSION == 3 && EIGEN_MAJOR_VERSION == 4 && !defined(EIGEN_VECTORIZE_AVX)
#define WHEELTAP_EIGEN_INSTANCES
#endif

#ifdef WHEELTAP_EIGEN_INSTANCES
#ifndef WHEELTAP_INSTANCE
#define WHEELTAP_INSTANCE extern
#endif

// NOLINTBEGIN(bugprone-macro-parentheses)
#define WHEELTAP_KERNEL(L, R)                                                                 \
  WHEELTAP_INSTANCE template struct gebp_kernel<                                              \
      L, R, Index, blas_data_mapper<ScalarBinaryOpTraits<L, R>::ReturnType, Index, ColMajor>, \
      gebp_traits<L, R>::mr, gebp_traits<L, R>::nr, false, false>;

#define WHEELTAP_PRODUCT(L, LeftOrder, R, RightOrder)                                              \
  WHEELTAP_INSTANCE template struct general_matrix_matrix_product<Index, L, LeftOrder, false, R,   \
                                                                  RightOrder, false, ColMajor, 1>; \
  WHEELTAP_INSTANCE template struct general_matrix_vector_product<                                 \
      Index, L, const_blas_data_mapper<L, Index, LeftOrder>, LeftOrder, false, R,                  \
      const_blas_data_mapper<R, Index, RightOrder>, false, 0>;

#define WHEELTAP_PRODUCTS(L, R)              \
  WHEELTAP_KERNEL(L, R)                      \
  WHEELTAP_PRODUCT(L, ColMajor, R, ColMajor) \
  WHEELTAP_PRODUCT(L, RowMajor, R, ColMajor) \
  WHEELTAP_PRODUCT(L, ColMajor, R, RowMajor) \
  WHEELTAP_PRODUCT(L, RowMajor, R, RowMajor)

#define WHEELTAP_TRIANGULAR(T, Mode, Order)                                                    \
  WHEELTAP_INSTANCE template struct triangular_solve_matrix<T, Index, OnTheLeft, Mode, false,  \
                                                            Order, ColMajor, 1>;               \
  WHEELTAP_INSTANCE template struct triangular_solve_matrix<T, Index, OnTheRight, Mode, false, \
                                                            Order, ColMajor, 1>;

#define WHEELTAP_TRIANGULARS(T, Order)     \
  WHEELTAP_TRIANGULAR(T, Lower, Order)     \
  WHEELTAP_TRIANGULAR(T, Upper, Order)     \
  WHEELTAP_TRIANGULAR(T, UnitLower, Order) \
  WHEELTAP_TRIANGULAR(T, UnitUpper, Order)
// NOLINTEND(bugprone-macro-parentheses)

namespace Eigen::internal {
WHEELTAP_PRODUCTS(double, double)
WHEELTAP_PRODUCTS(std::complex<double>, std::complex<double>)
WHEELTAP_PRODUCTS(std::complex<double>, double)
WHEELTAP_PRODUCTS(double, std::complex<double>)
WHEELTAP_TRIANGULARS(double, ColMajor)
WHEELTAP_TRIANGULARS(double, RowMajor)
WHEELTAP_TRIANGULARS(std::complex<double>, ColMajor)
WHEELTAP_TRIANGULARS(std::complex<double>, RowMajor)
}  // namespace Eigen::internal

#undef WHEELTAP_KERNEL
#undef WHEELTAP_PRODUCT
#undef WHEELTAP_PRODUCTS
#undef WHEELTAP_TRIANGULAR
#undef WHEELTAP_TRIANGULARS
#endif
