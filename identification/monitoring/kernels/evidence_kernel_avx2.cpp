#define WHEELTAP_EVIDENCE_KERNEL kAvx2Evidence
#define WHEELTAP_MONITORING_NAME "avx2"
#define WHEELTAP_MONITORING_WIDTH 4
#include "identification/monitoring/kernels/evidence_kernel_impl.hpp"
