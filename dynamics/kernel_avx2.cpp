#define WHEELTAP_KERNEL avx2
#define WHEELTAP_KERNEL_TABLE kAvx2Kernel
#define WHEELTAP_LANES 4
#include "dynamics/kernel_impl.hpp"
