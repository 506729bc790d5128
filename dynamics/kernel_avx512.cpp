#define WHEELTAP_KERNEL avx512
#define WHEELTAP_KERNEL_TABLE kAvx512Kernel
#define WHEELTAP_LANES 8
#include "dynamics/kernel_impl.hpp"
