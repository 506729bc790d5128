// Matrix products and solutions of triangular systems, compiled once.
//
// Eigen compiles a product C = A B in three versions for each combination of types of A, B and C: a
// blocked product (Goto & van de Geijn 2008), a loop for small matrices, and a matrix-vector
// product. The compilation of the dozens of expression types took half of the build time. This
// header makes Eigen pass products of real and complex matrices of any type to the functions
// `multiply` and `multiply_vector`, which only eigen_products.cpp compiles. These functions take
// addresses, sizes and strides. The results equal those of Eigen, because eigen_products.cpp calls
// Eigen's products for matrices with the same storage order.
//
// In a product of a real and a complex matrix, the real matrix is first converted to complex. An
// infinite entry then gives NaN; in Eigen, it gives an infinite result.
//
// Products of small matrices of fixed size are not changed: each source file compiles them.
//
// The names of the templates are those of Eigen 3.4. With another version of Eigen, or an
// instruction set other than that of the library build, this header declares nothing, and each
// source file compiles its own products.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <type_traits>

#if EIGEN_WORLD_VERSION == 3 && EIGEN_MAJOR_VERSION == 4 && !defined(EIGEN_VECTORIZE_AVX)
#define WHEELTAP_EIGEN_INSTANCES
#endif

#ifdef WHEELTAP_EIGEN_INSTANCES
#ifndef WHEELTAP_INSTANCE
#define WHEELTAP_INSTANCE extern
#endif

namespace wheeltap::products {

using Eigen::Index;
using Complex = std::complex<double>;

// A matrix in memory: entry (i, j) is data[i inner + j outer], or data[i outer + j inner] if the
// matrix is row-major.
template <class Scalar>
struct Dense {
  Scalar* data;
  Index rows;
  Index cols;
  Index outer;
  Index inner;
  bool by_rows;

  Dense transposed() const { return {data, cols, rows, outer, inner, !by_rows}; }
};

// A factor of a product. If `conjugate` is true, the complex conjugates of the entries are used.
template <class Scalar>
struct Factor {
  Dense<const Scalar> matrix;
  bool conjugate = false;

  Factor transposed() const { return {matrix.transposed(), conjugate}; }
};

// Computes C = scale A B, or C += scale A B if `add` is true. All matrices must have inner stride
// 1. Matrices without entries are allowed; C must not overlap A or B.
void multiply(const Factor<double>& a, const Factor<double>& b, double scale, bool add,
              const Dense<double>& c);
void multiply(const Factor<Complex>& a, const Factor<Complex>& b, Complex scale, bool add,
              const Dense<Complex>& c);
void multiply(const Factor<double>& a, const Factor<Complex>& b, Complex scale, bool add,
              const Dense<Complex>& c);
void multiply(const Factor<Complex>& a, const Factor<double>& b, Complex scale, bool add,
              const Dense<Complex>& c);

// Computes the product for column vectors b and c, whose inner strides may differ from 1.
void multiply_vector(const Factor<double>& a, const Factor<double>& b, double scale, bool add,
                     const Dense<double>& c);
void multiply_vector(const Factor<Complex>& a, const Factor<Complex>& b, Complex scale, bool add,
                     const Dense<Complex>& c);
void multiply_vector(const Factor<double>& a, const Factor<Complex>& b, Complex scale, bool add,
                     const Dense<Complex>& c);
void multiply_vector(const Factor<Complex>& a, const Factor<double>& b, Complex scale, bool add,
                     const Dense<Complex>& c);

template <class Scalar>
concept Multiplied = std::is_same_v<Scalar, double> || std::is_same_v<Scalar, Complex>;

// The types for which eigen_products.cpp calls Eigen's own products.
template <class X>
inline constexpr bool is_map = false;
template <class Plain, class Stride>
inline constexpr bool is_map<Eigen::Map<const Plain, Eigen::Unaligned, Stride>> = true;

template <class A, class B>
concept Passed =
    Multiplied<typename A::Scalar> && Multiplied<typename B::Scalar> && !(is_map<A> && is_map<B>);

// The parts of an operand of the form scale X, conj(X) or Xᵀ, where X is a matrix in memory. Any
// other expression is first evaluated to a matrix.
template <class Expression>
struct Operand {
  using Traits = Eigen::internal::blas_traits<Expression>;
  using Scalar = typename Expression::Scalar;
  typename Eigen::internal::add_const_on_value_type<typename Traits::DirectLinearAccessType>::type
      held;
  Scalar scale;

  explicit Operand(const Expression& x)
      : held(Traits::extract(x)), scale(Traits::extractScalarFactor(x)) {}
  Factor<Scalar> factor() const {
    return {{held.data(), held.rows(), held.cols(), held.outerStride(), held.innerStride(),
             bool(std::remove_cvref_t<decltype(held)>::IsRowMajor)},
            bool(Traits::NeedToConjugate)};
  }
};
template <class Nested>
struct Operand<Eigen::Transpose<Nested>> : Operand<std::remove_const_t<Nested>> {
  using Base = Operand<std::remove_const_t<Nested>>;
  explicit Operand(const Eigen::Transpose<Nested>& x) : Base(x.nestedExpression()) {}
  auto factor() const { return Base::factor().transposed(); }
};

// Calls `write` with the memory of the result. If the result cannot be written in place, calls
// `write` with the memory of a temporary matrix.
template <class Result, class Write>
void write_result(Result& result, bool add, bool strides_allowed, const Write& write) {
  using Scalar = typename Result::Scalar;
  if constexpr (bool(Result::Flags & Eigen::DirectAccessBit)) {
    if (strides_allowed || result.innerStride() == 1) {
      write(Dense<Scalar>{result.data(), result.rows(), result.cols(), result.outerStride(),
                          result.innerStride(), bool(Result::IsRowMajor)},
            add);
      return;
    }
  }
  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> whole(result.rows(), result.cols());
  write(Dense<Scalar>{whole.data(), whole.rows(), whole.cols(), whole.rows(), 1, false}, false);
  if (add)
    result += whole;
  else
    result = whole;
}

// result (+)= scale A B
template <class Result, class A, class B, class Scalar>
void pass_product(Result& result, const A& a, const B& b, Scalar scale, bool add) {
  const Operand<A> left(a);
  const Operand<B> right(b);
  write_result(result, add, false, [&](const Dense<Scalar>& c, bool sum) {
    multiply(left.factor(), right.factor(), scale * left.scale * right.scale, sum, c);
  });
}

// Computes result (+)= scale A B for a column vector B, or for A with a single row a: cᵀ = Bᵀ aᵀ.
template <class Result, class A, class B, class Scalar>
void pass_vector_product(Result& result, const A& a, const B& b, Scalar scale, bool add) {
  const Operand<A> left(a);
  const Operand<B> right(b);
  write_result(result, add, true, [&](const Dense<Scalar>& c, bool sum) {
    const Scalar factor = scale * left.scale * right.scale;
    if constexpr (A::IsVectorAtCompileTime)
      multiply_vector(right.factor().transposed(), left.factor().transposed(), factor, sum,
                      c.transposed());
    else
      multiply_vector(left.factor(), right.factor(), factor, sum, c);
  });
}

}  // namespace wheeltap::products

namespace Eigen::internal {

template <class A, class B>
requires wheeltap::products::Passed<A, B>
struct generic_product_impl<A, B, DenseShape, DenseShape, GemmProduct> {
  using Scalar = typename Product<A, B>::Scalar;

  template <class C>
  static void evalTo(C& c, const A& a, const B& b) {
    wheeltap::products::pass_product(c, a, b, Scalar(1), false);
  }
  template <class C>
  static void addTo(C& c, const A& a, const B& b) {
    wheeltap::products::pass_product(c, a, b, Scalar(1), true);
  }
  template <class C>
  static void subTo(C& c, const A& a, const B& b) {
    wheeltap::products::pass_product(c, a, b, Scalar(-1), true);
  }
  template <class C>
  static void scaleAndAddTo(C& c, const A& a, const B& b, const Scalar& scale) {
    wheeltap::products::pass_product(c, a, b, scale, true);
  }
};

template <class A, class B>
requires wheeltap::products::Passed<A, B>
struct generic_product_impl<A, B, DenseShape, DenseShape, GemvProduct> {
  using Scalar = typename Product<A, B>::Scalar;

  template <class C>
  static void evalTo(C& c, const A& a, const B& b) {
    wheeltap::products::pass_vector_product(c, a, b, Scalar(1), false);
  }
  template <class C>
  static void addTo(C& c, const A& a, const B& b) {
    wheeltap::products::pass_vector_product(c, a, b, Scalar(1), true);
  }
  template <class C>
  static void subTo(C& c, const A& a, const B& b) {
    wheeltap::products::pass_vector_product(c, a, b, Scalar(-1), true);
  }
  template <class C>
  static void scaleAndAddTo(C& c, const A& a, const B& b, const Scalar& scale) {
    wheeltap::products::pass_vector_product(c, a, b, scale, true);
  }
};

}  // namespace Eigen::internal

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
