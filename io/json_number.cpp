#include "io/json_number.hpp"

#include <nlohmann/json.hpp>

namespace wheeltap::io {

std::string json_number(double x) {
  return nlohmann::json(x).dump();
}

}  // namespace wheeltap::io
