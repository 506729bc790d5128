#define WHEELTAP_CANDIDATE_KERNEL kAvx2Candidates
#define WHEELTAP_MONITORING_NAME "avx2"
#define WHEELTAP_MONITORING_WIDTH 4
#include "identification/monitoring/kernels/candidate_kernel_impl.hpp"
