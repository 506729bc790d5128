#include "identification/findings/remarks.hpp"

namespace wheeltap::identification {

Remark::Remark(const Remark& other) = default;
Remark::Remark(Remark&& other) noexcept = default;
Remark& Remark::operator=(const Remark& other) = default;
Remark& Remark::operator=(Remark&& other) noexcept = default;
Remark::~Remark() = default;

}  // namespace wheeltap::identification
