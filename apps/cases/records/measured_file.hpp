// Sentences about a measured file: how it was read, and what is odd about its channels.
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

/// Columns that hold no numbers, a sentence each.
[[nodiscard]] std::vector<std::string> left_out_in_words(const MeasuredTable& table);

/// How a table was read, a sentence each: layout, times, units, what was left out.
[[nodiscard]] std::vector<std::string> reading_in_words(const MeasuredTable& table);

/// What is odd about a channel of a table, each the rest of a sentence that begins with its name.
[[nodiscard]] std::vector<std::string> oddities(const MeasuredTable& table,
                                                const MeasuredChannel& channel);

}  // namespace wheeltap::apps
