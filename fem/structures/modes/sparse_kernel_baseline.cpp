#define WHEELTAP_SPARSE_KERNEL kBaselineSparse
#define WHEELTAP_SPARSE_NAME "baseline"
#define WHEELTAP_SPARSE_WIDTH 2
#include "fem/structures/modes/sparse_kernel_impl.hpp"
