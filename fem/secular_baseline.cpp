#define WHEELTAP_SECULAR_KERNEL kBaselineKernel
#define WHEELTAP_SECULAR_NAME "baseline"
#define WHEELTAP_SECULAR_WIDTH 2
#include "fem/secular_impl.hpp"
