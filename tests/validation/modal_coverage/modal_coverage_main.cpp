// modal_coverage CASE RECORDS [SEED [NOISE [BLOCKS]]]: the study at length.
#include <cstdlib>
#include <iostream>

#include "modal_coverage.hpp"

int main(int argc, char** argv) {
  using namespace wheeltap::signals;
  if (argc < 3) {
    std::cerr << "modal_coverage chain|close|frame RECORDS [SEED [NOISE [BLOCKS]]]\n";
    return 64;
  }
  CoverageCase of = coverage_case(argv[1]);
  if (argc > 4) of.noise = std::atof(argv[4]);
  if (argc > 5) of.blocks = std::atoi(argv[5]);
  print(std::cout,
        modal_coverage(of, std::atoi(argv[2]), argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1));
  return 0;
}
