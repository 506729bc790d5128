// Signals by which users, schedulers and the system request a program to end.
#pragma once

#include <array>
#include <csignal>

namespace wheeltap::base {

/// The signals of Ctrl-C, `kill` and a closed terminal, and the two user signals. mpirun forwards
/// the user signals to its ranks; clusters send them before the time of a job ends (Slurm
/// optionally; Grid Engine and LSF: SIGUSR2). SIGXCPU reports the limit of processor time and
/// repeats every second (setrlimit(2)).
inline constexpr std::array kStopSignals{SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU};

}  // namespace wheeltap::base
