#define WHEELTAP_SECULAR_KERNEL kAvx2Kernel
#define WHEELTAP_SECULAR_NAME "avx2"
#define WHEELTAP_SECULAR_WIDTH 4
#include "fem/secular_impl.hpp"
