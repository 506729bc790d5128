#define WHEELTAP_PACKED_ROUTINES kAvx2Routines
#define WHEELTAP_PACKED_WIDTH 4
#include "inference/mixtures/packed_routines_impl.hpp"
