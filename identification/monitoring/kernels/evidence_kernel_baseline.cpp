#define WHEELTAP_EVIDENCE_KERNEL kBaselineEvidence
#define WHEELTAP_MONITORING_NAME "baseline"
#define WHEELTAP_MONITORING_WIDTH 2
#include "identification/monitoring/kernels/evidence_kernel_impl.hpp"
