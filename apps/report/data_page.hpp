// A page that draws a measured file.
#pragma once

#include <string>

#include "apps/cases/records/measured_file.hpp"

namespace wheeltap::apps {

/// One HTML file without anything from elsewhere: of each channel its history (the envelope where
/// there are more samples than pixels) and its spectrum with the peaks marked, with what is odd.
[[nodiscard]] std::string data_page(const MeasuredFile& file);

}  // namespace wheeltap::apps
