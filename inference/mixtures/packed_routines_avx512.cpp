#define WHEELTAP_PACKED_ROUTINES kAvx512Routines
#define WHEELTAP_PACKED_WIDTH 8
#include "inference/mixtures/packed_routines_impl.hpp"
