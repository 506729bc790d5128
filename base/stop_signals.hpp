// Signals by which users, schedulers and the system request a program to end.
#pragma once

#include <array>
#include <csignal>

namespace wheeltap::base {

/// Ctrl-C, `kill` and a closed terminal; the two user signals, which mpirun forwards to its ranks
/// and clusters send before the end of a job's time (Slurm optionally; Grid Engine and LSF:
/// SIGUSR2). SIGXCPU marks the limit of processor time and repeats every second (setrlimit(2)).
inline constexpr std::array kStopSignals{SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU};

}  // namespace wheeltap::base
