#define WHEELTAP_KERNEL baseline
#define WHEELTAP_KERNEL_TABLE kBaselineKernel
#define WHEELTAP_LANES 2
#include "dynamics/kernel_impl.hpp"
