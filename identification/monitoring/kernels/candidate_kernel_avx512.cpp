#define WHEELTAP_CANDIDATE_KERNEL kAvx512Candidates
#define WHEELTAP_MONITORING_NAME "avx512"
#define WHEELTAP_MONITORING_WIDTH 8
#include "identification/monitoring/kernels/candidate_kernel_impl.hpp"
