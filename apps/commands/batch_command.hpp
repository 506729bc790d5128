// wheeltap batch: many cases, each a run of its own.
#pragma once

#include "apps/run_options.hpp"

namespace wheeltap::apps {

/// Runs every case of the list (common.case_path, batch_list.hpp) by its kind, into a folder of its
/// name in common.output: as many at a time as there are threads, which the last ones share. Each
/// is a process of its own, so that none can end another. After each, `batch.csv` there holds all
/// rows so far (batch_table.hpp) and a line says what was found. With `resume`, finished runs are
/// verified by their checksums and kept, and those that were interrupted go on from their
/// checkpoints. A signal makes every run keep its checkpoint and end. Throws Failure with the exit
/// code of the first case of the list that failed, when all have ended.
void run_batch(const CommonOptions& common, const SamplingOptions& sampling);

}  // namespace wheeltap::apps
