#define WHEELTAP_PACKED_ROUTINES kBaselineRoutines
#define WHEELTAP_PACKED_WIDTH 2
#include "inference/mixtures/packed_routines_impl.hpp"
