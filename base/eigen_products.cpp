#define WHEELTAP_INSTANCE
#include "base/eigen_products.hpp"
