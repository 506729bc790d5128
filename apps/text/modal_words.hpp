// Sentences on identified modes, for terminal, summary and report.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/modal_case.hpp"

namespace wheeltap::apps {

/// Returns the reasons why a mode is doubtful, as clauses. The list is empty for a mode that is not
/// doubtful.
[[nodiscard]] std::vector<std::string> doubts_in_words(const signals::Mode& mode);
[[nodiscard]] std::vector<std::string> doubts_in_words(const signals::MergedMode& mode);

/// Returns the number of model orders in which the mode appears: "31 of 32", or "-" for methods
/// without model orders.
[[nodiscard]] std::string orders_in_words(int present, int orders);

/// Returns the reason why a cluster of poles is not a mode, as a clause.
[[nodiscard]] std::string rejection_in_words(signals::Rejection why);

/// Returns a sentence on the omitted single poles; empty if there are no omitted poles.
[[nodiscard]] std::string rejected_poles_in_words(const signals::ModalResult& result);

/// Returns one sentence per step of the identification: decimation, lags, blocks, orders.
[[nodiscard]] std::vector<std::string> procedure_in_words(const signals::ModalResult& result);

/// Returns sentences on the record: units of its channels, sampling, layout of the text file.
[[nodiscard]] std::vector<std::string> record_in_words(const SetUp& set_up);

/// Returns the warnings on the whole result of a modal identification.
[[nodiscard]] std::vector<std::string> warnings(const signals::ModalResult& result);

/// Returns the warnings on the whole result and the faults of the channels. With several set-ups,
/// the name of the file precedes each warning.
[[nodiscard]] std::vector<std::string> cautions(const SetUp& set_up,
                                                const signals::ModalResult& result);
[[nodiscard]] std::vector<std::string> cautions(const ModalCaseFile& modal,
                                                const IdentifiedModes& found);

/// Returns a sentence on the method by which set-ups were merged.
[[nodiscard]] std::string merging_in_words(const signals::MergedModes& merged, std::size_t set_ups);

/// Returns a value with its standard deviation, "1.2284 ± 0.0012", with two significant digits of
/// the standard deviation; "-" for NaN.
[[nodiscard]] std::string with_sd(double x, double sd);

}  // namespace wheeltap::apps
