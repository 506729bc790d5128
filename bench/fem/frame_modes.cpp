// Computes the first 20 modes of a plane frame of 2016 members; prints the smallest time of five
// rounds [s] and the frequencies. With a directory, writes the matrices k.mtx and m.mtx (Matrix
// Market) for a comparison with another solver (bench/python/frame_modes.py).
//
//   frame_modes ELEMENTS_PER_MEMBER [DIRECTORY]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "fem/structures/mesh.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "frames.hpp"

namespace {

void write(const std::string& path, const Eigen::SparseMatrix<double>& matrix) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) {
    std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
    std::exit(74);
  }
  const Eigen::SparseMatrix<double> lower = matrix.triangularView<Eigen::Lower>();
  std::fprintf(file, "%%%%MatrixMarket matrix coordinate real symmetric\n%ld %ld %ld\n",
               static_cast<long>(lower.rows()), static_cast<long>(lower.cols()),
               static_cast<long>(lower.nonZeros()));
  for (int c = 0; c < lower.outerSize(); ++c)
    for (Eigen::SparseMatrix<double>::InnerIterator it(lower, c); it; ++it)
      std::fprintf(file, "%ld %ld %.17g\n", static_cast<long>(it.row() + 1),
                   static_cast<long>(it.col() + 1), it.value());
  std::fclose(file);
}

}  // namespace

int main(int argc, char** argv) {
  const int elements = argc > 1 ? std::atoi(argv[1]) : 0;
  if (elements < 1) {
    std::fprintf(stderr, "usage: frame_modes ELEMENTS_PER_MEMBER [DIRECTORY]\n");
    return 64;
  }
  using namespace wheeltap;
  const fem::Mesh mesh(bench::frame(96, 10, elements, elements));
  const fem::Discretisation& d = mesh.discretisation();
  double least = 1e300;
  fem::StructureModes modes;
  for (int round = 0; round < 5; ++round) {
    const auto start = std::chrono::steady_clock::now();
    modes = fem::structure_modes(d, 20);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    least = std::min(least, taken.count());
  }
  std::printf("%ld degrees of freedom, %s, %.4f s\n", static_cast<long>(d.size()),
              modes.certified ? "certified" : "NOT certified", least);
  for (const double f : modes.frequencies_hz) std::printf("%.12g\n", f);
  if (argc > 2) {
    write(std::string(argv[2]) + "/k.mtx", d.stiffness);
    write(std::string(argv[2]) + "/m.mtx", d.mass);
  }
  return 0;
}
