// wheeltap batch: many cases, each in a separate run.
#pragma once

#include "apps/run_options.hpp"

namespace wheeltap::apps {

/// Runs every case of the list (common.case_path, batch_list.hpp) with the command of its kind. The
/// results of a case are in a subfolder of common.output; the subfolder has the name of the case.
/// Each thread runs one case at a time. When all cases have started, the running cases also use the
/// free threads. Each case is a separate process, so that a crash affects one case only. After each
/// case, `batch.csv` contains the rows of all finished cases (batch_table.hpp), and one line of
/// output reports the results. With `resume`, finished runs are verified by their checksums and
/// kept, and interrupted runs continue from their checkpoints. After a signal that requests a stop,
/// every run writes its checkpoint and ends. After the last case, throws Failure if any case
/// failed, with the exit code of the first failed case in the list.
void run_batch(const CommonOptions& common, const SamplingOptions& sampling);

}  // namespace wheeltap::apps
