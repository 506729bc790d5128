#define WHEELTAP_SPARSE_KERNEL kAvx2Sparse
#define WHEELTAP_SPARSE_NAME "avx2"
#define WHEELTAP_SPARSE_WIDTH 4
#include "fem/structures/modes/sparse_kernel_impl.hpp"
