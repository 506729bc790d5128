// Products of matrices against sums over entries, for every combination of scalars, storage orders,
// conjugation, strides, assignment and size.
#include <gtest/gtest.h>

#include <complex>
#include <vector>

#include "base/eigen.hpp"
#include "base/random.hpp"

namespace wheeltap {
namespace {

using Eigen::Dynamic;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using Complex = std::complex<double>;
template <class Scalar>
using ByRows = Eigen::Matrix<Scalar, Dynamic, Dynamic, Eigen::RowMajor>;
template <class Scalar>
using ByColumns = Eigen::Matrix<Scalar, Dynamic, Dynamic>;

base::Random& random() {
  static base::Random stream(7, 0, 0, base::Purpose::test);
  return stream;
}
void draw(double& x) {
  x = random().normal();
}
void draw(Complex& x) {
  x = {random().normal(), random().normal()};
}

template <class Matrix>
Matrix drawn(Index rows, Index cols) {
  Matrix out(rows, cols);
  for (Index j = 0; j < cols; ++j)
    for (Index i = 0; i < rows; ++i) draw(out(i, j));
  return out;
}

// Entry by entry; the operands may be any expressions.
template <class A, class B>
auto summed(const A& a, const B& b) {
  using Scalar = decltype(typename A::Scalar() * typename B::Scalar());
  ByColumns<Scalar> out = ByColumns<Scalar>::Zero(a.rows(), b.cols());
  for (Index i = 0; i < a.rows(); ++i)
    for (Index j = 0; j < b.cols(); ++j)
      for (Index k = 0; k < a.cols(); ++k) out(i, j) += a.coeff(i, k) * b.coeff(k, j);
  return out;
}

template <class C, class Expected>
void expect_close(const C& c, const Expected& expected, const char* what) {
  ASSERT_EQ(c.rows(), expected.rows()) << what;
  ASSERT_EQ(c.cols(), expected.cols()) << what;
  if (c.size() > 0) {
    EXPECT_LT((c - expected).cwiseAbs().maxCoeff(), 1e-12) << what;
  }
}

// Sums by coefficient (below 20), products of panels, matrices that are vectors, and empty ones.
struct Size {
  Index rows, depth, cols;
};
constexpr Size kSizes[] = {{3, 4, 2},  {30, 25, 40}, {30, 25, 1}, {1, 25, 30}, {1, 30, 1},
                           {2, 40, 2}, {0, 3, 4},    {3, 0, 4},   {30, 0, 40}, {3, 4, 0}};

template <class A, class B, class C>
void check_matrices() {
  using Scalar = typename C::Scalar;
  for (const Size& n : kSizes) {
    const A a = drawn<A>(n.rows, n.depth), tall = drawn<A>(n.depth, n.rows);
    const B b = drawn<B>(n.depth, n.cols), wide = drawn<B>(n.cols, n.depth);
    const C before = drawn<C>(n.rows, n.cols);
    C c = before;
    c.noalias() = a * b;
    expect_close(c, summed(a, b), "C = A B");
    c = before;
    c.noalias() += a * b;
    expect_close(c, before + summed(a, b), "C += A B");
    c = before;
    c.noalias() -= 2.0 * a * (-b);
    expect_close(c, before + Scalar(2.0) * summed(a, b), "C -= 2 A (-B)");
    c = tall.adjoint() * wide.transpose();
    expect_close(c, summed(tall.adjoint().eval(), wide.transpose().eval()), "C = Aᴴ Bᵀ");
    c = a * wide.adjoint() + before;
    expect_close(c, before + summed(a, wide.adjoint().eval()), "C = A Bᴴ + D");
    c = (a + a) * b.conjugate();
    expect_close(c, Scalar(2.0) * summed(a, b.conjugate().eval()), "C = (A + A) conj(B)");

    const A large_a = drawn<A>(n.rows + 3, n.depth + 2);
    const B large_b = drawn<B>(n.depth + 5, n.cols + 1);
    C large_c = drawn<C>(n.rows + 2, n.cols + 4);
    const C large_before = large_c;
    large_c.block(1, 2, n.rows, n.cols).noalias() +=
        large_a.block(2, 1, n.rows, n.depth) * large_b.block(3, 0, n.depth, n.cols);
    C expected = large_before;
    expected.block(1, 2, n.rows, n.cols) += summed(large_a.block(2, 1, n.rows, n.depth).eval(),
                                                   large_b.block(3, 0, n.depth, n.cols).eval());
    expect_close(large_c, expected, "blocks");
  }
}

TEST(EigenProducts, RealMatrices) {
  check_matrices<MatrixXd, MatrixXd, MatrixXd>();
  check_matrices<ByRows<double>, MatrixXd, ByRows<double>>();
  check_matrices<MatrixXd, ByRows<double>, MatrixXd>();
}
TEST(EigenProducts, ComplexMatrices) {
  check_matrices<MatrixXcd, MatrixXcd, ByRows<Complex>>();
  check_matrices<ByRows<Complex>, ByRows<Complex>, MatrixXcd>();
}
TEST(EigenProducts, RealTimesComplex) {
  check_matrices<ByRows<double>, MatrixXcd, MatrixXcd>();
}
TEST(EigenProducts, ComplexTimesReal) {
  check_matrices<MatrixXcd, MatrixXd, MatrixXcd>();
}

template <class Matrix, class Vector>
void check_vectors() {
  using Scalar = decltype(typename Matrix::Scalar() * typename Vector::Scalar());
  using Result = Eigen::Matrix<Scalar, Dynamic, 1>;
  for (const Index rows : {0, 1, 2, 33})
    for (const Index cols : {0, 1, 3, 41}) {
      const Matrix a = drawn<Matrix>(rows, cols);
      const Vector x = drawn<Vector>(cols, 1), y = drawn<Vector>(rows, 1);
      const Result before = drawn<Result>(rows, 1);
      Result c = before;
      c.noalias() = a * x;
      expect_close(c, summed(a, x), "c = A x");
      c = before;
      c.noalias() -= a * (3.0 * x);
      expect_close(c, before - Scalar(3.0) * summed(a, x), "c -= A 3 x");
      const Eigen::Matrix<Scalar, 1, Dynamic> row = y.adjoint() * a;
      expect_close(row, summed(y.adjoint().eval(), a), "c = yᴴ A");
      const ByColumns<Scalar> whole = a.adjoint() * y;
      expect_close(whole, summed(a.adjoint().eval(), y), "a matrix with one column");

      // Rows and columns of larger matrices: their entries are apart.
      const auto many = drawn<ByColumns<typename Vector::Scalar>>(3, cols);
      auto results = drawn<ByColumns<Scalar>>(4, rows);
      ByColumns<Scalar> expected = results;
      results.row(2).transpose().noalias() += a * many.row(1).transpose();
      expected.row(2) += summed(a, many.row(1).transpose().eval()).transpose();
      expect_close(results, expected, "rows of matrices");
    }
}

TEST(EigenProducts, RealVectors) {
  check_vectors<ByColumns<double>, VectorXd>();
  check_vectors<ByRows<double>, VectorXd>();
}
TEST(EigenProducts, ComplexVectors) {
  check_vectors<ByColumns<Complex>, VectorXcd>();
  check_vectors<ByRows<Complex>, VectorXcd>();
}
TEST(EigenProducts, MixedVectors) {
  check_vectors<ByColumns<double>, VectorXcd>();
  check_vectors<ByRows<Complex>, VectorXd>();
}

// Results whose entries are not one after another in memory: every second entry, chosen columns.
TEST(EigenProducts, ScatteredResults) {
  const MatrixXd a = drawn<MatrixXd>(4, 25), b = drawn<MatrixXd>(25, 3);
  std::vector<double> memory(4 * 3 * 2, 1.0);
  Eigen::Map<MatrixXd, Eigen::Unaligned, Eigen::Stride<Dynamic, Dynamic>> every_second(
      memory.data(), 4, 3, Eigen::Stride<Dynamic, Dynamic>(8, 2));
  every_second.noalias() += a * b;
  expect_close(every_second, summed(a, b) + MatrixXd::Ones(4, 3), "every second entry");
  for (std::size_t i = 1; i < memory.size(); i += 2) EXPECT_EQ(memory[i], 1.0);

  MatrixXd chosen = MatrixXd::Zero(4, 5);
  chosen(Eigen::all, std::vector<int>{4, 0, 2}) = a * b;
  expect_close(chosen(Eigen::all, std::vector<int>{4, 0, 2}), summed(a, b), "chosen columns");
}

// Factors and results that overlap are evaluated first, as in every product of Eigen.
TEST(EigenProducts, Aliases) {
  MatrixXd a = drawn<MatrixXd>(20, 20);
  const MatrixXd b = a;
  a = a * a.transpose();
  expect_close(a, summed(b, b.transpose().eval()), "A = A Aᵀ");
}

}  // namespace
}  // namespace wheeltap
