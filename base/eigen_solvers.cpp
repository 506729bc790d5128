#define WHEELTAP_SOLVER_INSTANCE
#include "base/eigen_solvers.hpp"
