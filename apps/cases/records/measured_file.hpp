// Sentences about a measured file: how it was read, and the faults of its channels.
#pragma once

#include <string>
#include <vector>

#include "signals/measured_file.hpp"

namespace wheeltap::apps {

using signals::look_at;
using signals::MeasuredChannel;
using signals::MeasuredFile;
using signals::MeasuredReading;
using signals::MeasuredTable;

/// Columns without numbers, one sentence per column.
[[nodiscard]] std::vector<std::string> left_out_in_words(const MeasuredTable& table);

/// How a table was read, one sentence per fact: layout, times, units, columns left out.
[[nodiscard]] std::vector<std::string> reading_in_words(const MeasuredTable& table);

/// Faults of a channel; each text completes a sentence that begins with the channel's name.
[[nodiscard]] std::vector<std::string> oddities(const MeasuredTable& table,
                                                const MeasuredChannel& channel);

}  // namespace wheeltap::apps
