#define WHEELTAP_SECULAR_KERNEL kAvx512Kernel
#define WHEELTAP_SECULAR_NAME "avx512"
#define WHEELTAP_SECULAR_WIDTH 8
#include "fem/secular_impl.hpp"
