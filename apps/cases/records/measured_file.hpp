// Sentences about a measured file: the layout that Wheeltap found, and the faults of the channels.
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

/// One sentence for each column that contains no numbers.
[[nodiscard]] std::vector<std::string> left_out_in_words(const MeasuredTable& table);

/// Sentences on the interpretation of a table, one per fact: layout, times, units, omitted columns.
[[nodiscard]] std::vector<std::string> reading_in_words(const MeasuredTable& table);

/// Faults of a channel; each text completes a sentence that begins with the channel's name.
[[nodiscard]] std::vector<std::string> oddities(const MeasuredTable& table,
                                                const MeasuredChannel& channel);

}  // namespace wheeltap::apps
