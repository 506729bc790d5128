#define WHEELTAP_KERNEL scalar
#define WHEELTAP_LANES 1
#include "dynamics/kernel_impl.hpp"
