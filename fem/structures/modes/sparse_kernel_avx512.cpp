#define WHEELTAP_SPARSE_KERNEL kAvx512Sparse
#define WHEELTAP_SPARSE_NAME "avx512"
#define WHEELTAP_SPARSE_WIDTH 4
#include "fem/structures/modes/sparse_kernel_impl.hpp"
