// What is said of identified modes, whoever prints it.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/modal_case.hpp"

namespace wheeltap::apps {

/// Why a mode is doubtful, each half a sentence; empty where it is not.
[[nodiscard]] std::vector<std::string> doubts_in_words(const signals::Mode& mode);
[[nodiscard]] std::vector<std::string> doubts_in_words(const signals::MergedMode& mode);

/// "31 of 32", "-" where the method has no orders.
[[nodiscard]] std::string orders_in_words(int present, int orders);

/// Why poles that belong together were no mode, half a sentence.
[[nodiscard]] std::string rejection_in_words(signals::Rejection why);

/// What is said of single poles that were left out; empty where none was.
[[nodiscard]] std::string rejected_poles_in_words(const signals::ModalResult& result);

/// What was done, a sentence each: decimation, lags, blocks, orders.
[[nodiscard]] std::vector<std::string> procedure_in_words(const signals::ModalResult& result);

/// How the record was read, a sentence each: units of its channels, times, layout of its text.
[[nodiscard]] std::vector<std::string> record_in_words(const SetUp& set_up);

/// What a reader should keep in mind of the whole.
[[nodiscard]] std::vector<std::string> warnings(const signals::ModalResult& result);

/// The same and its channels' oddities; of all set-ups, each under its file's name where there are
/// several.
[[nodiscard]] std::vector<std::string> cautions(const SetUp& set_up,
                                                const signals::ModalResult& result);
[[nodiscard]] std::vector<std::string> cautions(const ModalCaseFile& modal,
                                                const IdentifiedModes& found);

/// How set-ups were merged.
[[nodiscard]] std::string merging_in_words(const signals::MergedModes& merged, std::size_t set_ups);

/// "1.2284 ± 0.0012": two digits of the standard deviation; "-" of NaN.
[[nodiscard]] std::string with_sd(double x, double sd);

}  // namespace wheeltap::apps
