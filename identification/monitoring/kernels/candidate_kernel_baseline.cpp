#define WHEELTAP_CANDIDATE_KERNEL kBaselineCandidates
#define WHEELTAP_MONITORING_NAME "baseline"
#define WHEELTAP_MONITORING_WIDTH 2
#include "identification/monitoring/kernels/candidate_kernel_impl.hpp"
