#define WHEELTAP_INSTANCE
#include "base/eigen_products.hpp"

#ifdef WHEELTAP_EIGEN_INSTANCES

namespace wheeltap::products {
namespace {

using Eigen::ColMajor;
using Eigen::Dynamic;
using Eigen::RowMajor;
using Stride = Eigen::OuterStride<>;

template <class Scalar, int Order>
using Matrix = Eigen::Matrix<Scalar, Dynamic, Dynamic, Order>;
template <class Scalar, int Order>
using ConstMap = Eigen::Map<const Matrix<Scalar, Order>, Eigen::Unaligned, Stride>;
template <class Scalar>
using Vector = Eigen::Matrix<Scalar, Dynamic, 1>;

template <class Scalar>
using ConstVectorMap = Eigen::Map<const Vector<Scalar>, Eigen::Unaligned, Eigen::InnerStride<>>;
template <class Scalar>
using VectorMap = Eigen::Map<Vector<Scalar>, Eigen::Unaligned, Eigen::InnerStride<>>;

template <class Scalar, int Order>
ConstMap<Scalar, Order> mapped(const Dense<const Scalar>& m) {
  return {m.data, m.rows, m.cols, Stride(m.outer)};
}

// Distance between the entries of a column vector in memory.
template <class Scalar>
Index increment(const Dense<Scalar>& v) {
  return v.by_rows ? v.outer : v.inner;
}

template <class Scalar, int Left, int Right>
void multiply_stored(const Dense<const Scalar>& a, const Dense<const Scalar>& b, Scalar scale,
                     bool add, const Dense<Scalar>& c) {
  using A = ConstMap<Scalar, Left>;
  using B = ConstMap<Scalar, Right>;
  const A left = mapped<Scalar, Left>(a);
  const B right = mapped<Scalar, Right>(b);
  Eigen::Map<Matrix<Scalar, ColMajor>, Eigen::Unaligned, Stride> result(c.data, c.rows, c.cols,
                                                                        Stride(c.outer));
  // Chooses between sums by coefficient and products of panels like Eigen.
  if (b.rows > 0 && b.rows + c.rows + c.cols < EIGEN_GEMM_TO_COEFFBASED_THRESHOLD) {
    const auto sums = scale * left.lazyProduct(right);
    if (add)
      Eigen::internal::call_restricted_packet_assignment_no_alias(
          result, sums, Eigen::internal::add_assign_op<Scalar, Scalar>());
    else
      Eigen::internal::call_restricted_packet_assignment_no_alias(
          result, sums, Eigen::internal::assign_op<Scalar, Scalar>());
    return;
  }
  if (!add) result.setZero();
  Eigen::internal::generic_product_impl<A, B, Eigen::DenseShape, Eigen::DenseShape,
                                        Eigen::GemmProduct>::scaleAndAddTo(result, left, right,
                                                                           scale);
}

template <class Scalar>
void multiply_plain(const Dense<const Scalar>& a, const Dense<const Scalar>& b, Scalar scale,
                    bool add, const Dense<Scalar>& c) {
  if (c.by_rows) return multiply_plain(b.transposed(), a.transposed(), scale, add, c.transposed());
  if (a.by_rows && b.by_rows)
    return multiply_stored<Scalar, RowMajor, RowMajor>(a, b, scale, add, c);
  if (a.by_rows) return multiply_stored<Scalar, RowMajor, ColMajor>(a, b, scale, add, c);
  if (b.by_rows) return multiply_stored<Scalar, ColMajor, RowMajor>(a, b, scale, add, c);
  return multiply_stored<Scalar, ColMajor, ColMajor>(a, b, scale, add, c);
}

template <class Scalar, int Order>
void multiply_vector_stored(const Dense<const Scalar>& a, const Scalar* b, Scalar scale,
                            Scalar* c) {
  using A = ConstMap<Scalar, Order>;
  using B = Eigen::Map<const Vector<Scalar>>;
  Eigen::Map<Vector<Scalar>> result(c, a.rows);
  Eigen::internal::generic_product_impl<A, B, Eigen::DenseShape, Eigen::DenseShape,
                                        Eigen::GemvProduct>::scaleAndAddTo(result,
                                                                           mapped<Scalar, Order>(a),
                                                                           B(b, a.cols), scale);
}

template <class Scalar>
void multiply_vector_plain(const Dense<const Scalar>& a, const Dense<const Scalar>& b, Scalar scale,
                           bool add, const Dense<Scalar>& c) {
  Vector<Scalar> packed_factor;
  const Scalar* factor = b.data;
  if (increment(b) != 1) {
    packed_factor = ConstVectorMap<Scalar>(b.data, b.rows, Eigen::InnerStride<>(increment(b)));
    factor = packed_factor.data();
  }
  VectorMap<Scalar> result(c.data, c.rows, Eigen::InnerStride<>(increment(c)));
  if (!add) result.setZero();
  Vector<Scalar> packed_result;
  Scalar* sum = c.data;
  if (increment(c) != 1) {
    packed_result = result;
    sum = packed_result.data();
  }
  if (a.by_rows)
    multiply_vector_stored<Scalar, RowMajor>(a, factor, scale, sum);
  else
    multiply_vector_stored<Scalar, ColMajor>(a, factor, scale, sum);
  if (increment(c) != 1) result = packed_result;
}

// The entries of a factor as complex numbers, conjugated if `conjugate` of the factor is true.
template <class Scalar>
struct ComplexFactor {
  Matrix<Complex, ColMajor> entries;

  explicit ComplexFactor(const Factor<Scalar>& factor) {
    const Dense<const Scalar>& m = factor.matrix;
    const Index down = m.by_rows ? m.outer : m.inner;
    const Index right = m.by_rows ? m.inner : m.outer;
    entries.resize(m.rows, m.cols);
    for (Index j = 0; j < m.cols; ++j)
      for (Index i = 0; i < m.rows; ++i) {
        const Complex entry(m.data[i * down + j * right]);
        entries(i, j) = factor.conjugate ? std::conj(entry) : entry;
      }
  }
  Dense<const Complex> matrix() const {
    return {entries.data(), entries.rows(), entries.cols(), entries.rows(), 1, false};
  }
};

}  // namespace

void multiply(const Factor<double>& a, const Factor<double>& b, double scale, bool add,
              const Dense<double>& c) {
  multiply_plain(a.matrix, b.matrix, scale, add, c);
}
void multiply(const Factor<Complex>& a, const Factor<Complex>& b, Complex scale, bool add,
              const Dense<Complex>& c) {
  if (a.conjugate) return multiply({ComplexFactor(a).matrix()}, b, scale, add, c);
  if (b.conjugate) return multiply(a, {ComplexFactor(b).matrix()}, scale, add, c);
  multiply_plain(a.matrix, b.matrix, scale, add, c);
}
void multiply(const Factor<double>& a, const Factor<Complex>& b, Complex scale, bool add,
              const Dense<Complex>& c) {
  multiply({ComplexFactor(a).matrix()}, b, scale, add, c);
}
void multiply(const Factor<Complex>& a, const Factor<double>& b, Complex scale, bool add,
              const Dense<Complex>& c) {
  multiply(a, {ComplexFactor(b).matrix()}, scale, add, c);
}

void multiply_vector(const Factor<double>& a, const Factor<double>& b, double scale, bool add,
                     const Dense<double>& c) {
  multiply_vector_plain(a.matrix, b.matrix, scale, add, c);
}
void multiply_vector(const Factor<Complex>& a, const Factor<Complex>& b, Complex scale, bool add,
                     const Dense<Complex>& c) {
  if (a.conjugate) return multiply_vector({ComplexFactor(a).matrix()}, b, scale, add, c);
  if (b.conjugate) return multiply_vector(a, {ComplexFactor(b).matrix()}, scale, add, c);
  multiply_vector_plain(a.matrix, b.matrix, scale, add, c);
}
void multiply_vector(const Factor<double>& a, const Factor<Complex>& b, Complex scale, bool add,
                     const Dense<Complex>& c) {
  multiply_vector({ComplexFactor(a).matrix()}, b, scale, add, c);
}
void multiply_vector(const Factor<Complex>& a, const Factor<double>& b, Complex scale, bool add,
                     const Dense<Complex>& c) {
  multiply_vector(a, {ComplexFactor(b).matrix()}, scale, add, c);
}

}  // namespace wheeltap::products

#endif
