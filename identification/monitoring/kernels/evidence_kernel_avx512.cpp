#define WHEELTAP_EVIDENCE_KERNEL kAvx512Evidence
#define WHEELTAP_MONITORING_NAME "avx512"
#define WHEELTAP_MONITORING_WIDTH 8
#include "identification/monitoring/kernels/evidence_kernel_impl.hpp"
