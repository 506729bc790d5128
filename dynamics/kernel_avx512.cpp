#define WHEELTAP_KERNEL avx512
#define WHEELTAP_LANES 8
#include "dynamics/kernel_impl.hpp"
